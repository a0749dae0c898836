// The methods of other people that Rigproof is compared with, each written from its mathematics (docs/methods.md).
#pragma once

#include <vector>

#include "rigproof/calib/method.h"

namespace rigproof {

/// MEMROC as the authors' program computes it, with its known failures: a start that takes the board's axes for the
/// robot's, rotations compared as rotation vectors, consecutive stops only, heights of the first stop never read, and
/// any level plane taken for the ground, a ceiling too. Reads clouds or depth images where the recording has them,
/// else the observed planes.
const Method& memroc_reference_method();
const Method& joint_memroc_reference_method();

/// OpenCV's calibrateHandEye: Tsai-Lenz, Park, Horaud, Andreff, Daniilidis. A robot that turns about one axis only is
/// outside of what they are made for, and the numbers show it.
std::vector<const Method*> opencv_hand_eye_methods();

/// Li, Heng, Koser, Pollefeys 2013: bundle adjustment of a pattern that several cameras see. Camera to camera only.
const Method& li_method();

/// RobotAutocalib (Zuniga-Noel et al. 2019) as published: motions and points of the ground from features in the images,
/// with a free scale.
const Method& robot_autocalib_method();
/// The same with the board's motions and the planes of the depth images.
const Method& robot_autocalib_board_method();

/// SensorX2Car (Yan et al. 2023), camera to car: rotation only, from the direction in which features stream on straight
/// steps and the axis of the turns.
const Method& sensorx2car_method();

/// Whether a method opens the images, depth images or clouds of a recording, rather than its observations alone.
bool reads_files(const Method& method);

/// All of them, in the order in which they are listed.
const std::vector<const Method*>& rival_methods();

}  // namespace rigproof
