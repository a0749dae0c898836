// A configuration worked out: the world, the stops, what is recorded and what is true. Everything but the images.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/generator/config.h"
#include "rigproof/generator/coverage.h"
#include "rigproof/generator/motion.h"
#include "rigproof/generator/sensors.h"
#include "rigproof/generator/viewpoints.h"
#include "rigproof/sim/models.h"
#include "rigproof/sim/world.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// A file outside of the configuration that the images depend on.
struct ScenarioInput {
  std::string name;  ///< relative to the data folder where it lies there, else the file's name
  std::string sha256;
};

/// A frame of one camera that is recorded.
struct FrameJob {
  std::size_t stop = 0;
  std::size_t camera = 0;
  CameraFrame files;
  int color_parts = 1;  ///< pictures that the image is put together from: see exposures.h
  int depth_parts = 1;
};

/// When a camera's rows are exposed.
struct CameraShutter {
  double exposure_s = 0.01;
  double readout_s = 0.0;        ///< 0 = global shutter
  double depth_readout_s = 0.0;  ///< of the depth image
  double gamma = 2.2;            ///< of the image's levels
};

struct Scenario {
  GenerateConfig config;
  RigModel rig;
  std::vector<ScenarioInput> inputs;
  std::string scene_text;  ///< every field of the scene as it was varied: see rigproof::scene_text
  std::unique_ptr<World> world;
  ViewpointSubject subject;
  ViewpointPlan plan;
  std::vector<CameraCoverage> coverage;  ///< of the plan's viewpoints
  std::vector<Rigid3> T_scene_robot;     ///< at every stop: on the viewpoints of the plan, or where it drove
  RobotTrajectory trajectory;            ///< of a driven run, by the stamps of the recording; else empty
  std::size_t ways_tried_again = 0, viewpoints_replaced = 0;  ///< of a driven run
  std::vector<SensorModel> sensors;                           ///< one a camera
  std::vector<CameraShutter> shutters;                        ///< one a camera
  Recording recording;                                        ///< its folder is empty: the caller's
  std::vector<FrameJob> frames;                               ///< of the recording, stop by stop
  Truth truth;
  std::string drive_key, drive_bytes;  ///< of a driven run, for its file: see drive_store.h

  std::size_t stop_count() const { return T_scene_robot.size(); }
  /// T_scene_robot without the stops of the straight drive.
  std::vector<Rigid3> viewpoint_poses() const {
    return {T_scene_robot.begin(), T_scene_robot.end() - static_cast<std::ptrdiff_t>(plan.straight)};
  }
  std::size_t camera_count() const { return rig.rig.cameras.size(); }
  bool sensor_images_are_jpeg() const { return config.sensor_noise != "none" && config.sensing.image.jpeg_quality > 0; }
  std::size_t frame_count() const { return frames.size(); }
  /// When a frame is taken, and where the robot is then.
  const TrueStop& truth_of(const FrameJob& job) const { return truth.stops_of(job.camera)[job.stop]; }
};

/// motion: drive.
struct DriveSource {
  std::filesystem::path run, cache;  ///< folders that may hold the drive; empty = none
  /// Told of the viewpoints reached, and how many they are, of a drive that has to be simulated; false interrupts it.
  std::function<bool(std::size_t, std::size_t)> progress;
};

/// Loads what the configuration names and plans the drive. Throws Error with every problem found, or kTryAgain where
/// the drive was interrupted.
Scenario resolve_scenario(const GenerateConfig& config, const DriveSource& source = {});

/// The files that the images of a run depend on, without planning it.
std::vector<ScenarioInput> scenario_inputs(const GenerateConfig& config);

}  // namespace rigproof
