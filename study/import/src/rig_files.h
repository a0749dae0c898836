// The files of a recording that describe it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "rigproof/core/camera_info.h"
#include "rigproof/core/recording.h"
#include "rigproof/formats/frame_tree.h"
#include "rigproof/study/import/init.h"

namespace rigproof {

struct RigText {
  const Rig& rig;
  bool has_board = false;
  std::vector<std::string> comments;  ///< lines before it
};

/// rig.yaml as a person would write it: the depth block of a camera without a sensor holds only what is known.
std::string rig_yaml_text(const RigText& text);

/// Files of --camera-info by camera: CAMERA=FILE, or FILE alone, which is for all and has to be Kalibr's camchain.
/// Throws Error.
std::map<std::string, std::string> intrinsics_files(const std::vector<std::string>& texts,
                                                    const std::vector<std::string>& cameras);

/// Intrinsics of a camera_info file, or of the camera of a camchain that has the topic, or else the name. Throws Error
/// with every problem.
/// @param topic of the images; empty: they are files
InfoReading camera_of_file(const std::filesystem::path& file, const std::string& name, const std::string& topic);

/// How cameras stand to each other by the camchains that their intrinsics are of: each in the first one of its file.
/// @param of_topics their images are topics
FrameTree poses_of_chain(const std::vector<InitCamera>& cameras, bool of_topics);

}  // namespace rigproof
