// Which of a stream's images are worth keeping: a few of each stop.
#pragma once

#include <cstddef>
#include <vector>

#include "rigproof/core/recording.h"

namespace rigproof {

struct FrameChoiceOptions {
  bool every_image = false;
  int images_per_stop = 3;
};

struct FrameChoice {
  std::vector<std::vector<std::size_t>> kept;  ///< [camera] indices into its stamps, ascending
  std::size_t stops = 0;                       ///< places at which the robot stood still and had an image taken
  std::vector<std::size_t> stops_of_camera;    ///< [camera] those with an image of it
  std::size_t moving = 0;                      ///< images left out because the robot moved
  std::size_t surplus = 0;                     ///< images of stops left out
  std::size_t outside = 0;                     ///< images left out before the odometry begins or after it ends
  bool on_the_move = false;                    ///< the robot hardly stood still: images along the way are kept instead
};

/// @param stamps_s [camera] ascending
/// A robot stands still where its odometry moves by less than 1 cm/s and 0.01 rad/s within a tenth of a second before
/// and after; images between which it moved by less than 5 mm and 5 mrad are of one stop. Where there are fewer than
/// three stops, an image every 5 cm or 3 degrees is kept.
FrameChoice choose_frames(const std::vector<std::vector<double>>& stamps_s, const std::vector<OdometrySample>& odometry,
                          const FrameChoiceOptions& options);

}  // namespace rigproof
