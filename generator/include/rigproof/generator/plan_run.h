// A run without its pictures, and other odometry for one whose pictures are there.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/generator/config.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// Everything that generate() would write but the images.
struct PlannedRun {
  Recording recording;  ///< its folder is empty, its images do not exist
  Truth truth;
};

/// Throws Error with every problem of the configuration, or the constraint that leaves no viewpoints.
PlannedRun plan_run(const GenerateConfig& config);

/// Whether a run's pictures do not depend on its `odometry`: not where the robot really drives.
bool odometry_is_apart(const GenerateConfig& config);

/// What the wheels of a run would have told under `config.odometry`, in place of what they told: the same that
/// generate() writes for this configuration. The run must have been generated with the default odometry and else the
/// same configuration, and odometry_is_apart().
void replace_odometry(const GenerateConfig& config, Recording* recording, Truth* truth);

/// "SHA-256 name" of every file beside the configuration that a run depends on: scene, robot, rig, sensors, textures.
std::vector<std::string> run_inputs(const GenerateConfig& config);

}  // namespace rigproof
