// A recording: everything that a real robot could record, and nothing else. It never holds the truth.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/rig.h"

namespace rigproof {

/// One image of one camera, with what belongs to it. On disk a line of <camera>/frames.csv: file,stamp_s,exposure_s.
struct CameraFrame {
  std::string color_file;   ///< relative to the recording's folder, e.g. "left/color/000000.png"
  std::string depth_file;   ///< 16-bit PNG; empty if there is none
  std::string cloud_file;   ///< .pcd or text "x y z" in the colour camera's frame [m]; empty if there is none
  double stamp_s = 0.0;     ///< middle of the exposure
  double exposure_s = 0.0;  ///< 0 = unknown
  int line = 0;             ///< line in frames.csv for messages, 0 = not from a file
};

/// One line of odometry.csv: T_odom_robot projected to the ground.
struct OdometrySample {
  double stamp_s = 0.0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// A stretch of a recording that is not meant for board calibration, which leaves its frames alone: they are no stops.
/// On disk a line of segments.csv: kind,begin_s,end_s.
struct RecordingSegment {
  std::string kind;  ///< straight: the robot drives straight ahead, at least three frames a camera, no board needed
  double begin_s = 0.0;
  double end_s = 0.0;

  bool holds(double stamp_s) const { return stamp_s >= begin_s && stamp_s <= end_s; }
};
inline constexpr const char* kStraightSegment = "straight";

struct Recording {
  std::filesystem::path folder;
  Rig rig;
  std::vector<std::vector<CameraFrame>> frames;  ///< [camera][frame], by stamp
  std::vector<OdometrySample> odometry;          ///< by strictly increasing stamp
  std::vector<RecordingSegment> segments;        ///< usually none

  /// True if the frame serves a segment instead of the board.
  bool in_segment(const CameraFrame& frame) const;
  /// The frames of one camera that lie in a segment, by stamp.
  std::vector<CameraFrame> frames_of(const RecordingSegment& segment, std::size_t camera) const;
};

/// The odometry, which is of the point about which the robot turns, as that of the robot's origin.
std::vector<OdometrySample> odometry_of_origin(const Recording& recording);

/// Reads a recording folder: rig.yaml, odometry.csv and the list of frames of every camera. Images are not opened.
/// Throws Error with every problem found (file:line, field, value, what is allowed).
Recording load_recording(const std::filesystem::path& folder);

/// Writes rig.yaml, odometry.csv and every frames.csv, each atomically. Images are the caller's.
void save_recording(const Recording& recording);

/// Rig alone, for presets in models/rigs and for rig.yaml. `folder` resolves relative file names.
Rig load_rig(const std::filesystem::path& file);
void save_rig(const Rig& rig, const std::filesystem::path& file);
/// What save_rig() writes.
std::string rig_text(const Rig& rig);

}  // namespace rigproof
