// From what a robot's owner has, a bag of ROS 2, to a recording that can be calibrated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/board.h"

namespace rigproof {

struct InitOptions {
  std::filesystem::path source;
  std::filesystem::path output;  ///< a new folder
  std::optional<Board> board;    ///< absent: rig.yaml has no line for it yet
  /// odometry=TOPIC, NAME=TOPIC (images), NAME.depth=TOPIC, NAME.camera_info=TOPIC; `none` for a topic leaves it out,
  /// tf_static=none the robot's static frames.
  std::vector<std::string> topics;
  std::filesystem::path odometry;         ///< trajectory of a folder of images; empty: the only one in it
  std::vector<std::string> camera_infos;  ///< NAME=FILE in place of the bag's CameraInfo, or FILE of Kalibr for all
  std::vector<std::string> sensors;       ///< NAME=PRESET, or PRESET for all
  std::string robot_frame;                ///< empty: found in the bag's TF, or base_footprint
  bool log_stamps = false;                ///< times of recording in place of the headers' stamps
  bool every_image = false;               ///< also those that are taken while the robot moves, and all of a stop
  int images_per_stop = 3;                ///< of each camera
  int threads = 0;                        ///< for looking at boards; 0 = all cores
  /// Called with what is being done ("read", "write", "board"), how much is done and how much there is (bytes, images);
  /// returns false to interrupt, which throws Error with ExitCode::kTryAgain.
  std::function<bool(const char*, std::uint64_t, std::uint64_t)> progress;
};

struct InitCamera {
  std::string name;
  std::string images;       ///< topic
  std::string camera_info;  ///< topic or file
  std::string depth;        ///< topic; empty: none
  std::string link;         ///< in the robot's TF tree
  int width_px = 0, height_px = 0;
  std::size_t images_in_source = 0;
  std::size_t images_kept = 0;
  std::size_t depth_kept = 0;
  std::size_t stops = 0;                   ///< with an image of this camera
  std::optional<std::size_t> board_stops;  ///< stops at which the board is in its image; absent: not looked for
  std::optional<std::size_t> board_cells;  ///< of kImageCells, parts of its image with a corner of the board; likewise
};

struct InitReport {
  std::filesystem::path folder;
  std::vector<InitCamera> cameras;
  std::string odometry;  ///< topic
  std::size_t odometry_rows = 0;
  double duration_s = 0.0;  ///< of the odometry
  double tilt_deg = 0.0;    ///< largest angle between the robot's vertical and that of the odometry frame
  double rise_m = 0.0;      ///< highest less lowest position
  std::string robot_frame;
  std::size_t stops = 0;
  std::size_t moving_images = 0;     ///< left out, taken while the robot moved
  std::vector<std::string> notes;    ///< what a user should know
  std::vector<std::string> missing;  ///< what rig.yaml still needs: the line to write
  std::uint64_t bytes = 0;           ///< of the source
  std::uint64_t unpacked_bytes = 0;
};

/// Reads the source and writes a recording: rig.yaml, odometry.csv, images, and tf_static.json with the robot's static
/// TF. The folder appears whole or not at all; nothing in its place is overwritten. Throws Error that says what to do.
InitReport init_recording(const InitOptions& options);

}  // namespace rigproof
