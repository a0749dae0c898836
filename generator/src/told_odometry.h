// What a robot's odometry tells of a planned run, and what is true of it.
#pragma once

#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/generator/config.h"
#include "rigproof/sim/models.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// Odometry of a teleported robot at the truth's stops, by the law of the configuration; labels the truth with what was
/// drawn.
void tell_odometry(const GenerateConfig& config, const RobotModel& robot, Recording* recording, Truth* truth);

/// What the owner of a robot on one driven axle knows: it turns about its middle, within 5 mm.
void tell_driven_axle(Rig* rig);

/// Odometry whose noise is no law of its own: the truth is labelled with the nearest one.
void label_odometry(const std::vector<OdometrySample>& odometry, Truth* truth);

}  // namespace rigproof
