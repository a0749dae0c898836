// Pictures of a recording as messages.
#pragma once

#include <string>

#include "rigproof/bags/messages.h"
#include "rigproof/core/recording.h"

namespace rigproof {

struct PictureMessage {
  std::string type;
  std::string transport;  ///< behind the topic: "", "/compressed" or "/compressedDepth"
  std::string bytes;
};

/// Throws Error that names the file.
PictureMessage color_message_of(const std::filesystem::path& file, const RosHeader& header, bool compressed);
/// 16UC1 where the files have millimetres, as ROS has them (REP 118); else 32FC1, metres.
PictureMessage depth_message_of(const std::filesystem::path& file, const RosHeader& header, double unit_m,
                                bool compressed);
/// Throws Error that names the file.
PictureMessage cloud_message_of(const std::filesystem::path& file, const RosHeader& header);
RosCameraInfo camera_info_of(const Camera& camera, const RosHeader& header);

}  // namespace rigproof
