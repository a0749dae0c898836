// Recordings with one thing wrong each, from the files on, and the findings that name it: what people do to theirs, in
// sizes from just noticeable to absurd. tests/study/recording_faults_test.cpp checks the table, bench_faults measures.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "faulty_recording.h"

namespace rigproof::faults {

/// What of a recording a fault changes.
enum class Files { kRig, kOdometry, kFrames, kColor, kDepth, kClouds };

/// Stands among the codes of a fault for an Error that is no finding: a file that cannot be read is named by itself.
inline constexpr const char* kError = "error";

struct RecordingFault {
  std::string name;                ///< unique, with its size
  std::string part;                ///< what is broken: lens, board, depth, odometry, convention, time, pictures, place
  std::vector<std::string> codes;  ///< of the findings that name it as they should
  std::set<Files> files;           ///< that it changes, and no others
  std::function<void(FaultyRecording*)> apply;
  std::function<bool(const Rig&)> fits = {};     ///< whether a rig can have it; empty: every rig can
  std::set<std::string> variants = {};           ///< names of those whose images it takes
  std::string cannot_show = {};                  ///< why no data can show it; empty: they can
  std::vector<std::string> codes_if_alone = {};  ///< more of them where it is the rig's only camera
};

std::vector<RecordingFault> lens_faults();
std::vector<RecordingFault> board_faults();
std::vector<RecordingFault> depth_faults();
std::vector<RecordingFault> odometry_faults();
std::vector<RecordingFault> time_faults();
std::vector<RecordingFault> picture_faults();
std::vector<RecordingFault> place_faults();

/// All of them, with names that are unique.
const std::vector<RecordingFault>& recording_faults();
/// Two at once: both codes name it.
std::vector<RecordingFault> recording_fault_pairs();
/// Throws std::logic_error for a name that no fault has.
const RecordingFault& fault_named(const std::string& name);

/// The same drive once more, with cameras, board or print changed: images for faults that no file can be edited to.
struct Variant {
  std::string name;  ///< as FaultyRecording::replace_by_variant() takes it
  double camera_pitch_deg = 0.0, camera_yaw_deg = 0.0;
  double camera_forward_m = 0.0;                     ///< of every camera, along the robot's x
  double board_turn_deg = 0.0, board_aside_m = 0.0;  ///< about the vertical, and along the wall
  double print_scale_x = 1.0, bow_mm = 0.0;
};
const std::vector<Variant>& variants();

// For the files of the table.

bool has_two_cameras(const Rig& rig);
bool has_two_depth_cameras(const Rig& rig);
bool has_distortion(const RigCamera& camera);
/// "focal length of one camera", 2, " %" as "focal length of one camera +2 %".
std::string sized(const std::string& what, double size, const std::string& unit);

}  // namespace rigproof::faults
