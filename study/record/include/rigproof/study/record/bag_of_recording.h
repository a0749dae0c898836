// A recording as the bag that its robot would have recorded: for programs that read ROS 2.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/core/recording.h"

namespace rigproof {

struct BagOptions {
  bool compressed_images = false;  ///< pictures stay the files that they are; else they are unpacked: sensor_msgs/Image
  std::string packing = "zstd";    ///< of chunks: one of bag_packings()
  /// Called with (images done, images in all); return false to interrupt, which throws Error with kTryAgain.
  std::function<bool(std::size_t, std::size_t)> progress;
};
std::vector<std::string> bag_packings();
/// What users call such a bag among layouts.
inline constexpr const char* kBagLayout = "mcap";

struct BagReport {
  std::size_t images = 0, depth_images = 0, clouds = 0, odometry = 0;
  std::vector<std::string> topics;
  std::vector<std::string> notes;  ///< what the bag does not say, in sentences
};

/// Writes an MCAP file: pictures, depth, clouds and CameraInfo of every camera, odometry, /tf_static (of
/// tf_static.json, or how optical frames lie in their links: where those are mounted is what is sought), by the stamps
/// of the recording. One picture at a time is in memory. The file appears whole or not at all; throws Error if there is
/// something already, and for pictures that cannot be read.
BagReport write_bag(const Recording& recording, const std::filesystem::path& file, const BagOptions& options = {});

}  // namespace rigproof
