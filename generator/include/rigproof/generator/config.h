// The configuration of a run: what `rigproof generate CONFIG` reads. Every field has a default; {} is a valid file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/distribution.h"
#include "rigproof/core/fields.h"
#include "rigproof/generator/board_config.h"
#include "rigproof/generator/motion.h"
#include "rigproof/generator/odometry_errors.h"
#include "rigproof/generator/sensing.h"
#include "rigproof/generator/straight_drive_config.h"
#include "rigproof/sim/scene_variation.h"

namespace rigproof {

/// The board and where it stands.
struct BoardConfig {
  std::string preset;            ///< in models/boards, or a file; empty = the rig's board
  std::string type = "preset";   ///< preset | checkerboard | charuco | aprilgrid
  std::vector<double> squares;   ///< two numbers replace the preset's; empty = the preset's
  double square_mm = 0.0;        ///< 0 = the preset's
  std::string dictionary;        ///< of a charuco's markers, as OpenCV calls it; empty = the preset's
  std::string place = "fitted";  ///< fitted | scene: where the scene puts it; given: the fields below
  Distribution x_m = 0.0;
  Distribution y_m = 0.0;
  Distribution z_m = 0.8;
  Distribution facing_deg = 0.0;
  Distribution lean_deg = 0.0;
  Distribution roll_deg = 0.0;
  BoardDefectsConfig defects;
  // Of further boards: how well the recording tells where they stand against the first one.
  double told_place_sigma_mm = 0.0;  ///< 0 = it does not; with `sensing.told: exact`, too, this error is drawn
  double told_place_sigma_deg = 0.5;

  void visit(FieldVisitor& visitor);
};

/// One explicit place of the robot, in the frame that ViewpointConfig::list_frame names.
struct ListedViewpoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_deg = 0.0;

  void visit(FieldVisitor& visitor);
};

/// Every combination of distance, bearing and heading.
struct GridConfig {
  std::vector<double> distances_m = {1.4, 2.0, 2.6, 3.2};
  std::vector<double> bearings_deg = {-40.0, -20.0, 0.0, 20.0, 40.0};
  std::vector<double> headings_deg = {-8.0, 0.0, 8.0};

  void visit(FieldVisitor& visitor);
};

/// Where the robot stands when it takes images.
struct ViewpointConfig {
  std::string planner = "covering";  ///< covering | sampled | grid | list
  Distribution distance_m = Distribution::Kind(Distribution::Uniform{1.2, 3.6});
  Distribution bearing_deg = Distribution::Kind(Distribution::Uniform{-55.0, 55.0});
  Distribution heading_deg = Distribution::Kind(Distribution::Uniform{-25.0, 25.0});
  std::int64_t min_cameras = 1;
  double all_cameras_share = 0.9;
  double margin_px = 8.0;
  double max_obliquity_deg = 60.0;
  std::int64_t max_candidates = 400;
  std::string order = "drive";  ///< drive | drawn
  double step_m = 1.6;
  GridConfig grid;
  std::vector<ListedViewpoint> list;
  std::string list_frame = "scene";  ///< scene | board: on the floor below its centre, x towards the viewers

  /// Whether places are drawn at random, so that there are as many stops as are asked for.
  bool draws() const { return planner == "covering" || planner == "sampled"; }
  void visit(FieldVisitor& visitor);
};

/// What the robot's wheels tell.
struct OdometryConfig {
  std::int64_t seed = -1;               ///< of the odometry's noise; -1 = as everything else that is not rendered
  std::string model = "per_increment";  ///< per_increment | per_pose | thrun | wheels
  double lambda = 1.0;
  double sigma_xy_cm = 0.2;
  double sigma_yaw_rad = 0.01;
  Distribution scale = 1.0;
  Distribution yaw_factor = 1.0;
  double rate_hz = 0.0;
  bool declared = false;
  ThrunConfig thrun;
  WheelsConfig wheels;

  void visit(FieldVisitor& visitor);
};

/// How the clean picture is drawn.
struct RenderConfig {
  double psf_sigma_px = 0.6;
  bool board_at_double = true;
  bool whole_at_double = false;
  bool lens_residual = true;
  // Of a robot that takes images while it moves:
  bool motion_blur = true;
  bool rolling_shutter = true;
  Distribution exposure_ms = 0.0;  ///< drawn for each camera; 0 = its sensor preset's
  Distribution readout_ms = 0.0;   ///< the same
  std::int64_t max_parts = 64;     ///< of an exposure: pictures that are drawn for one image

  void visit(FieldVisitor& visitor);
};

struct GenerateConfig {
  std::string name;
  std::int64_t seed = 0;
  std::string scene = "indoor_lab";
  std::vector<std::string> scenes;  ///< several worlds, one run each; see runs_of() in dataset.h
  SceneVariation randomize;
  std::string rig = "husky_3x_d455";
  std::string depth_frame = "rig";  ///< rig | registered | raw
  double image_scale = 1.0;
  std::int64_t poses = 100;
  double stop_period_s = 2.0;
  std::string motion = "teleport";  ///< teleport | drive
  DriveConfig drive;
  BoardConfig board;
  std::vector<BoardConfig> more_boards;  ///< with a place of their own
  ViewpointConfig viewpoints;
  StraightDriveConfig straight_drive;
  OdometryConfig odometry;
  std::string sensor_noise = "realistic";  ///< realistic | none
  Distribution depth_scale_bias_percent = 0.0;
  SensingConfig sensing;
  RenderConfig render;
  std::string clouds = "none";  ///< none | pcd
  std::int64_t cloud_stride_px = 2;
  std::int64_t png_level = 0;

  /// The first board, or one of the others.
  const BoardConfig& board_at(std::size_t index) const { return index == 0 ? board : more_boards[index - 1]; }
  bool moves_while_exposing() const { return motion == "drive" && drive.capture == "moving"; }
  void visit(FieldVisitor& visitor);
};

/// Reads a configuration. An empty file gives the defaults; the name defaults to the file's. Throws Error with every
/// problem found.
GenerateConfig load_generate_config(const std::filesystem::path& file);
GenerateConfig parse_generate_config(const std::string& text, const std::filesystem::path& file = "config");

/// YAML with every field: reads back to the same configuration.
std::string resolved_text(const GenerateConfig& config);

/// JSON Schema of a configuration, as it ships in config/schema/run.json.
std::string generate_config_schema();

/// What differs, one "field: A there, B here" an entry; empty if nothing does.
std::vector<std::string> differences(const GenerateConfig& there, const GenerateConfig& here);

}  // namespace rigproof
