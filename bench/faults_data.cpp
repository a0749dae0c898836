#include "faults_data.h"

#include <algorithm>
#include <stdexcept>

#include "faults/recording_faults.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/generate.h"
#include "rigproof/truth/truth.h"

namespace rigproof::bench {
namespace {

namespace fs = std::filesystem;
using faults::Variant;

struct Mounted {
  const char* name;
  const char* sensor;
  const char* intrinsics;  ///< empty: the sensor's
  double x_m, y_m, z_m, roll_deg, pitch_deg, yaw_deg;
};

struct FaultRig {
  const char* name;
  const char* robot;
  const char* board;
  const char* run;  ///< what else a run with it needs
  int more_stops;
  std::vector<Mounted> cameras;
};

constexpr const char* kD455 =
    "{width_px: 1280, height_px: 720, fx_px: 641.3, fy_px: 640.2, cx_px: 644.1, cy_px: 355.8, lens: brown_conrady, "
    "distortion: [-0.0553, 0.0654, -0.0003, 0.0007, -0.0211]}";
constexpr const char* kD435 =
    "{width_px: 1280, height_px: 720, fx_px: 921.4, fy_px: 919.8, cx_px: 646.2, cy_px: 352.7, lens: brown_conrady, "
    "distortion: [0.135, -0.42, 0.0006, -0.0004, 0.36]}";

const std::vector<FaultRig>& rigs() {
  static const std::vector<FaultRig> all = {
      {"husky",
       "husky",
       "checkerboard_5x4_100mm",
       "viewpoints: {planner: sampled}\n",
       0,
       {{"left", "d455", kD455, 0.235, 0.2, 0.7, 2, 16, 14},
        {"center", "d455", "", 0.26, 0.01, 0.64, 0, 12, 1},
        {"right", "d455", kD455, 0.23, -0.2, 0.725, -3, 20, -15}}},
      // Of twelve headings five let the rear camera see the board.
      {"cart",
       "cart",
       "checkerboard_6x5_110mm",
       "viewpoints: {planner: sampled, all_cameras_share: 0, heading_deg: {choice: [-13, -8, -4, 1, 5, 9, 14, 170, "
       "175, 179, -176, "
       "-171]}}\n"
       "odometry: {rate_hz: 20}\n",
       8,
       {{"front", "d435", kD435, 0.2, 0.06, 0.62, 1, 3, -2},
        {"wide", "fisheye", "", -0.17, 0, 0.92, 0, 24, 3},
        {"rear", "l515", "", -0.28, 0.02, 0.6, 0, 3, 178}}},
      {"single",
       "husky",
       "checkerboard_5x4_100mm",
       "viewpoints: {planner: sampled}\nodometry: {rate_hz: 20}\n",
       0,
       {{"front", "d455", kD455, 0.26, 0, 0.68, 0, 15, 0}}},
  };
  return all;
}

const FaultRig& rig_named(const std::string& name) {
  const auto found = std::find_if(rigs().begin(), rigs().end(), [&](const FaultRig& rig) { return rig.name == name; });
  if (found == rigs().end()) throw Error("--rigs: " + name + ": " + suggestion(name, fault_rigs()));
  return *found;
}

std::string rig_text(const FaultRig& rig, const Variant& variant) {
  std::string text = std::string("robot: ") + rig.robot + "\nboard: " + rig.board + "\ncameras:\n";
  for (const Mounted& c : rig.cameras) {
    const auto entry = [](const char* key, double value) { return std::string(key) + ": " + number_text(value); };
    text += std::string("  ") + c.name + ":\n    sensor: " + c.sensor + "\n    mount: {" +
            joined({entry("x_m", c.x_m + variant.camera_forward_m), entry("y_m", c.y_m), entry("z_m", c.z_m),
                    entry("roll_deg", c.roll_deg), entry("pitch_deg", c.pitch_deg + variant.camera_pitch_deg),
                    entry("yaw_deg", c.yaw_deg + variant.camera_yaw_deg)}) +
            "}\n" + (*c.intrinsics ? std::string("    intrinsics: ") + c.intrinsics + "\n" : "");
  }
  return text;
}

std::string world_of(std::uint64_t seed) {
  // Wide enough for every variant of a drive.
  const char* const worlds[] = {"indoor_lab", "workshop", "office", "warehouse"};
  return worlds[seed % 4];
}

std::string run_text(const fs::path& rig_file, std::uint64_t seed, const DriveKind& kind) {
  return "include: " + kind.pictures + "\nscene: " + world_of(seed) + "\nseed: " + std::to_string(seed) + "\nrig: \"" +
         rig_file.string() + "\"\nimage_scale: " + number_text(kind.image_scale) + "\n";
}

void generate_run(const std::string& text, const fs::path& folder) {
  const fs::path manifest = RunFolder{folder}.manifest_file();
  if (fs::exists(manifest) && load_manifest(manifest).complete) return;
  GenerateOptions options;
  options.output = folder;
  generate(parse_generate_config(text, "run"), options);
}

// On the floor below the board's centre, x towards its viewers: the frame of a list of viewpoints.
Rigid3 board_on_floor(const Truth& truth) {
  const Eigen::Vector3d centre = truth.T_world_board * truth.board.centre();
  const Eigen::Vector3d outward = -(truth.T_world_board.rotation * Eigen::Vector3d::UnitZ());
  return planar_pose(centre.x(), centre.y(), std::atan2(outward.y(), outward.x()));
}

// The stops before the board where the variant puts it; the world turns with the robot instead of the board.
std::string list_text(const Truth& truth, const Variant& variant) {
  const Rigid3 T_board_moved = planar_pose(0.0, variant.board_aside_m, deg_to_rad(variant.board_turn_deg));
  const Rigid3 T_moved_world = T_board_moved.inverse() * board_on_floor(truth).inverse();
  std::string text;
  for (const TrueStop& stop : truth.stops) {
    const Rigid3 robot = T_moved_world * stop.T_world_robot;
    text += std::string(text.empty() ? "" : ", ") + "{x_m: " + number_text(robot.translation.x()) +
            ", y_m: " + number_text(robot.translation.y()) + ", yaw_deg: " + number_text(rad_to_deg(yaw_of(robot))) +
            "}";
  }
  return "poses: " + std::to_string(truth.stops.size()) +
         "\nviewpoints: {planner: list, list_frame: board, order: drawn, list: [" + text + "]}\n";
}

// What the variant does not change stays as the seed draws it.
std::string board_text(const Variant& variant) {
  std::vector<std::string> defects;
  if (variant.print_scale_x != Variant().print_scale_x)
    defects.push_back("print_scale_x: " + number_text(variant.print_scale_x));
  if (variant.bow_mm != Variant().bow_mm) defects.push_back("bow_mm: " + number_text(variant.bow_mm));
  return "board: {place: scene" + (defects.empty() ? "" : ", defects: {" + joined(defects) + "}") + "}\n";
}

fs::path rig_file_of(const fs::path& run) { return run.string() + ".rig.yaml"; }

}  // namespace

const std::vector<std::string>& fault_rigs() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const FaultRig& rig : rigs()) all.emplace_back(rig.name);
    return all;
  }();
  return names;
}

fs::path drive_of(const fs::path& data, const std::string& rig_name, std::uint64_t seed, const DriveKind& kind) {
  const FaultRig& rig = rig_named(rig_name);
  const fs::path run = fs::absolute(data) / (rig_name + "-" + std::to_string(seed) + kind.name);
  write_file_atomically_unsynced(rig_file_of(run), rig_text(rig, {}));
  generate_run(run_text(rig_file_of(run), seed, kind) + "poses: " + std::to_string(kind.stops + rig.more_stops) +
                   "\nboard: {place: scene}\n" + rig.run,
               run);
  return run;
}

void add_variants(const fs::path& run, const std::string& rig_name, std::uint64_t seed, const DriveKind& kind,
                  const std::set<std::string>& names) {
  const FaultRig& rig = rig_named(rig_name);
  const Truth truth = load_truth(RunFolder{run}.truth_file());
  for (const Variant& variant : faults::variants()) {
    if (names.count(variant.name) == 0) continue;
    const fs::path folder = run.string() + "-" + variant.name;
    write_file_atomically_unsynced(rig_file_of(folder), rig_text(rig, variant));
    generate_run(run_text(rig_file_of(folder), seed, kind) + list_text(truth, variant) + board_text(variant), folder);
  }
}

}  // namespace rigproof::bench
