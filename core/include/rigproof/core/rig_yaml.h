// The parts of a rig as YAML, shared by rig.yaml, sensor and board presets, observations.json and the truth.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/fields.h"
#include "rigproof/core/rig.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// How the cameras of a rig are read.
struct RigReadOptions {
  /// Folder of the recording: camera_info.yaml is looked up in the camera's folder below. Empty: not looked up.
  std::filesystem::path folder;
  /// A camera without intrinsics takes the nominal ones of its sensor: right for a simulator, never for a real robot.
  bool nominal_intrinsics = false;
  std::size_t max_cameras = 64;
};

// Where something is wrong what was read is incomplete: throw the problems.

/// {type: checkerboard, squares: [6, 5], square_mm: 110}, or the name of a preset in models/boards.
void visit_fields(FieldVisitor& visitor, Board& board);
/// The block alone.
void visit_board(FieldVisitor& visitor, Board& board);
/// {translation_m, quaternion_xyzw, sigma_mm, sigma_deg}.
void visit_fields(FieldVisitor& visitor, BoardPlace& place);
/// Whether there is a list `more_boards` to be visited; one that is too long is a problem.
bool takes_more_boards(FieldVisitor& visitor, bool has_some);
/// `more_boards`, a list of boards, each with its `place`; left out where there are none.
void visit_more_boards(FieldVisitor& visitor, std::vector<Board>& boards);
/// width_px height_px fx_px fy_px cx_px cy_px lens distortion.
void visit_fields(FieldVisitor& visitor, Camera& camera);
/// The same, where another key may stand for some of them: none is required.
void visit_camera(FieldVisitor& visitor, Camera& camera);
void visit_fields(FieldVisitor& visitor, DepthNoise& noise);
/// `exact`, or {focal_percent, focal_ratio_percent, principal_point_px, distortion_px}.
void visit_fields(FieldVisitor& visitor, IntrinsicsSigma& sigma);
/// unit_m min_m max_m noise camera T_color_depth; what is absent stays as it is.
void visit_fields(FieldVisitor& visitor, DepthStream& depth);
/// Intrinsics and T_color_depth.
void visit_fields(FieldVisitor& visitor, DepthStream::OwnCamera& camera);
/// {model: per_increment, sigma_xy_mm: 2, sigma_yaw_deg: 0.5}.
void visit_fields(FieldVisitor& visitor, OdometryNoise& noise);
/// rotation_centre_mm, left out where it is the origin.
void visit_rotation_centre(FieldVisitor& visitor, Eigen::Vector2d& centre_m, const char* description);
/// {xy_mm: 8, z_mm: 4, angle_deg: 0.2}.
void visit_fields(FieldVisitor& visitor, AcceptLimits& accept);
/// {translation_m: [x, y, z], quaternion_xyzw: [x, y, z, w]}. A norm within 1e-3 of 1 is normalised.
void visit_fields(FieldVisitor& visitor, Rigid3& T);
/// The same two keys in a block that has others, too.
void visit_pose(FieldVisitor& visitor, Rigid3& T, bool is_required = true);
/// Further keys of a camera; a reader has appended the camera to the list before.
using VisitMount = std::function<void(FieldVisitor&)>;
/// The map `cameras:`, in the file's order; each has sensor folder link intrinsics camera_info depth.
void visit_rig_cameras(FieldVisitor& visitor, const RigReadOptions& options, std::vector<RigCamera>& cameras,
                       const VisitMount& visit_mount = {});
/// rig.yaml of a recording in `folder`, where camera_info.yaml is looked up.
void visit_rig(FieldVisitor& visitor, const std::filesystem::path& folder, Rig& rig);
/// True if a name can be a frame name and a folder: letters, digits, "_", "-", ".", at most 64, no leading dot.
bool is_frame_name(const std::string& name);

/// What a data sheet says of a stereo camera.
struct StereoGeometry {
  double focal_px = 0.0;  ///< of the pictures that are matched
  double baseline_m = 0.0;
  double disparity_sigma_px = 0.0;
};

/// A sensor that cameras of a rig name: models/sensors/NAME.yaml.
struct SensorPreset {
  std::string name;
  std::string description;
  Camera camera;                     ///< nominal intrinsics of the colour stream
  IntrinsicsSigma intrinsics_sigma;  ///< how well those of a device are known
  std::optional<DepthStream> depth;
  /// Where the device measures depth before its driver registers it to colour: `depth.raw` of the preset.
  std::optional<DepthStream::OwnCamera> raw_depth;
  bool delivers_raw_depth = false;  ///< `depth_frame: raw`: what a rig with this sensor has unless it says otherwise
  std::optional<StereoGeometry> stereo;  ///< where the preset gives it; the law in `depth` follows from it
};
/// True of "mine.yaml": a file in place of a preset's name.
bool names_sensor_file(const std::string& sensor);
/// A preset by name, or a file. Throws Error with every problem of it, or with the nearest name if there is none.
/// @param simulation the fields of the block `simulation`, which only a simulator knows. Without it nothing of that
/// block is read but how large the device's fixed depth error is.
SensorPreset load_sensor_preset(const std::string& name, const VisitFields& simulation = {});
/// A board of models/boards by name, or a file. Throws Error.
Board load_board(const std::string& name_or_path);

}  // namespace rigproof
