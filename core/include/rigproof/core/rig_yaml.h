// The parts of a rig as YAML, shared by rig.yaml, sensor and board presets, observations.json and the truth.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/rig.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/core/sensor_simulation.h"
#include "rigproof/core/yaml.h"

namespace rigproof {

/// How the cameras of a rig are read.
struct RigReadOptions {
  /// Folder of the recording: camera_info.yaml is looked up in the camera's folder below. Empty: not looked up.
  std::filesystem::path folder;
  /// A camera without intrinsics takes the nominal ones of its sensor: right for a simulator, never for a real robot.
  bool nominal_intrinsics = false;
};

// Every reader asks `map` for the keys it knows and reports what is wrong with them; the caller may ask for more keys
// and then calls map.finish(). Where something is wrong the value returned is incomplete: throw the problems.

/// {type: checkerboard, squares: [6, 5], square_mm: 110}, or the name of a preset in models/boards.
Board read_board(const YamlTree& tree, const std::string& path, Problems* problems);
/// width_px height_px fx_px fy_px cx_px cy_px lens distortion.
Camera read_intrinsics(MapReader& map);
/// The block `depth`: unit_m min_m max_m noise camera T_color_depth; what is absent stays as in `preset`.
DepthStream read_depth_stream(MapReader& map, const DepthStream& preset);
/// sensor link folder intrinsics camera_info depth.
RigCamera read_rig_camera(const std::string& name, MapReader& map, const RigReadOptions& options);
/// The map `cameras:`, in the file's order.
std::vector<RigCamera> read_rig_cameras(const YamlTree& tree, const std::string& path, const RigReadOptions& options,
                                        Problems* problems);
/// {model: per_increment, sigma_xy_mm: 2, sigma_yaw_deg: 0.5}.
OdometryNoise read_odometry_noise(MapReader& map);
/// {xy_mm: 8, z_mm: 4, angle_deg: 0.2}.
AcceptLimits read_accept_limits(MapReader& map);
/// {translation_m: [x, y, z], quaternion_xyzw: [x, y, z, w]}. A norm within 1e-3 of 1 is normalised.
Rigid3 read_transform(MapReader& map);
/// True if a name can be a frame name and a folder: letters, digits, "_", "-", ".", at most 64, no leading dot.
bool is_frame_name(const std::string& name);

// What writes the same.
YamlTree tree_of(const Board& board);
YamlTree tree_of(const Camera& camera);
YamlTree tree_of(const DepthStream& depth);
YamlTree tree_of(const RigCamera& camera);
YamlTree tree_of(const OdometryNoise& noise);
YamlTree tree_of(const AcceptLimits& accept);
/// A map that other entries can be added to.
YamlTree tree_of(const Rigid3& T);
void set_transform(const Rigid3& T, YamlTree* map);

/// A value in a key's unit such that value / units_per_si reads back to the same double, with as few digits as can be.
double value_in_unit(double value, double units_per_si);

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
  Camera camera;  ///< nominal intrinsics of the colour stream
  std::optional<DepthStream> depth;
  /// Where the device measures depth before its driver registers it to colour: `depth.raw` of the preset.
  std::optional<DepthStream::OwnCamera> raw_depth;
  bool delivers_raw_depth = false;  ///< `depth_frame: raw`: what a rig with this sensor has unless it says otherwise
  std::optional<StereoGeometry> stereo;  ///< where the preset gives it; the law in `depth` follows from it
  SensorSimulation simulation;
};
/// Throws Error with every problem of the preset, or with the nearest name if there is none.
SensorPreset load_sensor_preset(const std::string& name);
/// A board of models/boards by name, or a file. Throws Error.
Board load_board(const std::string& name_or_path);

}  // namespace rigproof
