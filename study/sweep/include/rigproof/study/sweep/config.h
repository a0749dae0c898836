// The configuration of a sweep, and its tasks. docs/guides/sweeps.md explains it by example.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/core/fields.h"
#include "rigproof/core/yaml.h"
#include "rigproof/generator/config.h"
#include "rigproof/geometric/geometric.h"
#include "rigproof/study/sweep/rows.h"

namespace rigproof {

/// Block `geometric` of a sweep: what observations without pictures are drawn from.
struct GeometricSweepConfig {
  std::string rig = "reference";  ///< reference | random | run
  std::int64_t cameras = 3;       ///< of a random rig
  std::string drive = "random";   ///< not with rig: run
  std::string measured;           ///< observations whose noise of corners and planes is drawn; with rig: run only
  double corner_sigma_px = 0.1;
  bool ground = true;
  bool board_planes = false;
  double inverse_depth_sigma_per_m = 0.0025;
  double ground_points = 300.0;
  double board_points = 60.0;
  double depth_scale_sigma = 0.0;  ///< not with rig: run, nor the next two
  double suspension_height_sigma_mm = 0.0;
  double suspension_tilt_sigma_deg = 0.0;
  double corner_outlier_fraction = 0.0;
  double odometry_outlier_fraction = 0.0;
  double plane_outlier_fraction = 0.0;

  void visit(FieldVisitor& visitor);
};

/// One level of an axis: the fields that it sets, by dotted path.
struct SweepLevel {
  std::string label;
  double value = 0.0;  ///< of a level that is one number, else its place 0, 1, ..
  std::vector<std::pair<std::string, YamlTree>> fields;
};

/// Levels at equal distances, or ratios.
struct SweepRange {
  double from = 0.0, to = 0.0;
  std::optional<double> step;
  std::int64_t count = 0;  ///< instead of a step; 0 = none
  bool log = false;
  std::vector<double> values;  ///< what it says

  void visit(FieldVisitor& visitor);
};

struct SweepAxis {
  std::string name;
  std::string title;  ///< for people; empty = the name
  bool pooled = false;
  std::string field;  ///< of values and range
  YamlTree values;    ///< as the file has them, or nothing; as link and points
  std::optional<SweepRange> range;
  YamlTree link, points;
  std::vector<std::string> labels;
  std::vector<SweepLevel> levels;  ///< what all of these say
};

/// How images are looked at: --ground, --features and --horizon of `rigproof calibrate`.
struct SweepVision {
  std::string ground = "depth";   ///< depth | images | auto
  std::string features = "sift";  ///< sift | onnx:FILE, with an absolute path
  std::string horizon;            ///< onnx:FILE, or none

  /// Equal for the same choices, for people and hashes: "ground images, features sift".
  std::string text() const;
};

/// A method as the configuration names it.
struct SweepMethodChoice {
  std::string method = "ml";  ///< as `rigproof methods` lists them, or external:FILE.yaml with an absolute path
  std::string name;           ///< in the tables; empty = the method's own
  SweepVision vision;

  const std::string& label() const { return name.empty() ? method : name; }
};

struct SweepConfig {
  std::string name;
  bool geometric = false;
  YamlTree run = YamlTree::map();              ///< block of a run's fields, includes merged in
  YamlTree geometric_block = YamlTree::map();  ///< fields of GeometricSweepConfig
  std::vector<SweepAxis> axes;
  std::vector<std::int64_t> seeds = {0};
  std::vector<std::string> seed_fields;  ///< that the seeds are given to; none: the run's own seeds stand
  SweepVision vision;                    ///< of methods that say nothing else
  std::vector<SweepMethodChoice> methods = {SweepMethodChoice()};
  std::string reference = "ml";  ///< SweepMethodChoice::label() of one of them
};

/// Reads a sweep's file. Throws Error with every problem found, those of the levels' values among them.
/// @param overrides "run.poses=20", "seeds=2": FIELD=VALUE by dotted paths in the file, as overrides.h has them
SweepConfig load_sweep_config(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});
/// The same as a file that reads back to it.
YamlTree resolved_sweep(SweepConfig config);
/// JSON Schema of a sweep's file.
std::string sweep_config_schema();

/// Throws Error with every problem of every point, at the first of the seeds.
void check_sweep(const SweepConfig& config);
/// Every task: point by point, the last axis fastest; the seeds of a point together. Throws Error with every problem of
/// every task.
std::vector<SweepTask> plan_sweep(const SweepConfig& config);
/// Throws Error if a planned task would now be another one: a file that the configuration names has changed.
void check_planned(const SweepConfig& config, const std::vector<SweepTask>& tasks);

/// What the point and the seed of a task say.
struct TaskSettings {
  GenerateConfig config;
  GeometricSweepConfig geometric;
  std::int64_t images = 0;  ///< stops that are used, 0 = all
};
TaskSettings settings_of(const SweepConfig& config, const SweepTask& task);

/// Pictures that one or more tasks share: everything of a run but its odometry.
struct PictureSet {
  std::string key;
  GenerateConfig config;
  std::string render_group;  ///< sets of one group share clean renders
};
/// Those of a task that has some.
PictureSet pictures_of(const SweepConfig& config, const SweepTask& task);

}  // namespace rigproof
