// Presets of sensors and boards.
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/file_schemas.h"
#include "rigproof/core/rig_yaml.h"

namespace rigproof {
namespace {

constexpr NumberRange kFieldOfView{1.0, 170.0};

// {width_px, height_px, hfov_deg}: square pixels, centred; or full intrinsics.
void visit_nominal_camera(FieldVisitor& visitor, Camera& camera) {
  double field_of_view = 90.0;
  const bool by_view = visitor.takes("hfov_deg", false);
  if (by_view)
    visitor.field("hfov_deg", field_of_view, kFieldOfView,
                  "horizontal field of view, in place of all but the size: square pixels, centred, no distortion");
  if (!by_view) return visit_fields(visitor, camera);
  visitor.require("width_px", "the width of the image in pixels");
  visitor.require("height_px", "the height of the image in pixels");
  if (!visitor.is_reading()) return visit_camera(visitor, camera);
  camera.width_px = camera.height_px = 1;
  visitor.field("width_px", camera.width_px, {1.0, 32768.0}, "");
  visitor.field("height_px", camera.height_px, {1.0, 32768.0}, "");
  const double focal_px = 0.5 * camera.width_px / std::tan(0.5 * deg_to_rad(field_of_view));
  // Whole where it is meant to be: 640, not 640.0000000000001.
  camera = Camera::symmetric(camera.width_px, camera.height_px, std::round(focal_px * 1e6) * 1e-6);
}

// What the data sheet of a stereo camera gives: sigma of 1/z = s / (f B).
struct StereoSheet {
  double width_px = 848.0, hfov_deg = 90.0, baseline_m = 0.1, disparity_sigma_px = 0.1;

  void visit(FieldVisitor& visitor) {
    for (const char* key : {"width_px", "hfov_deg", "baseline_m", "disparity_sigma_px"})
      visitor.require(key, "a number");
    visitor.field("width_px", width_px, {1.0, 32768.0}, "width of the pictures that are matched");
    visitor.field("hfov_deg", hfov_deg, kFieldOfView, "horizontal field of view of those pictures");
    visitor.field("baseline_m", baseline_m, {1e-4, 10.0}, "between the two imagers");
    visitor.field("disparity_sigma_px", disparity_sigma_px, {1e-4, 10.0}, "noise of the disparity, one sigma");
  }

  StereoGeometry geometry() const {
    return {0.5 * width_px / std::tan(0.5 * deg_to_rad(hfov_deg)), baseline_m, disparity_sigma_px};
  }
};

void visit_raw_depth(FieldVisitor& visitor, DepthStream::OwnCamera& raw) {
  visit_nominal_camera(visitor, raw.camera);
  visitor.require("T_color_depth", "{translation_m, quaternion_xyzw}");
  visitor.nested("T_color_depth", raw.T_color_depth, "pose of the depth camera in the colour camera");
}

void visit_preset_depth(FieldVisitor& visitor, SensorPreset& preset) {
  const auto read_none = [](const std::string& text) {
    if (text != "none") throw Error("must be none or a block");
  };
  if (visitor.instead({{}, "none: the sensor measures no depth", read_none})) return;
  std::optional<StereoSheet> sheet;
  visitor.nested("stereo", sheet, "data sheet of a stereo camera, which its noise law follows from");
  DepthStream depth;
  if (sheet) {
    const StereoGeometry stereo = sheet->geometry();
    preset.stereo = stereo;
    depth.noise.inverse_depth_sigma_per_m = stereo.disparity_sigma_px / (stereo.focal_px * stereo.baseline_m);
  }
  visit_fields(visitor, depth);
  DepthStream::OwnCamera raw;
  const bool has_raw = visitor.takes("raw", false);
  if (has_raw)
    visitor.section(
        "raw", [&raw](FieldVisitor& block) { visit_raw_depth(block, raw); },
        "the device's depth camera, before its driver registers depth to colour");
  if (!visitor.is_reading()) return;
  preset.depth = depth;
  if (has_raw) preset.raw_depth = raw;
}

void visit_preset(FieldVisitor& visitor, SensorPreset& preset, const VisitFields& simulation) {
  std::vector<std::string> sources;
  visitor.field("description", preset.description, TextChoices{}, "one sentence");
  visitor.field("sources", sources, "where its figures are from");
  visitor.require("color", "a block of intrinsics");
  visitor.section(
      "color", [&preset](FieldVisitor& block) { visit_nominal_camera(block, preset.camera); },
      "nominal intrinsics of the colour camera");
  visitor.nested("intrinsics_sigma", preset.intrinsics_sigma,
                 "how well the intrinsics that are told of a device are known, one sigma");
  if (visitor.takes("depth", preset.depth.has_value()))
    visitor.section(
        "depth", [&preset](FieldVisitor& block) { visit_preset_depth(block, preset); }, "the depth stream");
  visitor.choice("depth_frame", preset.delivers_raw_depth, {{"registered", false}, {"raw", true}},
                 "raw: a rig with this sensor has depth.raw unless it says otherwise");
  visitor.check(!preset.delivers_raw_depth || preset.raw_depth, "depth_frame",
                "raw needs a block depth.raw: {width_px, height_px, hfov_deg, T_color_depth}");
  if (visitor.takes("simulation", false) && simulation)
    visitor.section("simulation", simulation, "how strong the effects are that a simulator shows");
  visitor.tolerate("x-");
}

// A real device of this kind has the fixed error that a simulated one may have; a block `noise` that states it
// prevails.
void state_depth_bias(const YamlTree& device, const std::optional<StereoGeometry>& stereo, DepthNoise* noise) {
  if (noise->has_bias()) return;
  Problems ignored;  // they are for the simulator to tell
  MapReader map(device, "simulation.depth", &ignored);
  const double bias_px = map.number("bias_px").value_or(0.05), bias_m = map.number("bias_m").value_or(0.003);
  if (stereo) noise->bias_inverse_depth_per_m = bias_px / (stereo->focal_px * stereo->baseline_m);
  if (noise->law == DepthNoise::Law::kTimeOfFlight) noise->bias_m = bias_m;
  noise->bias_cell_deg = map.number("bias_cell_deg").value_or(15.0);
}

}  // namespace

std::string sensor_schema(const VisitFields& simulation) {
  SensorPreset preset;
  return schema_of_fields("Rigproof sensor", [&](FieldVisitor& visitor) { visit_preset(visitor, preset, simulation); },
                          {1, false});
}

std::string board_schema() {
  // In its own file a board is no name of another one.
  Board board;
  return schema_of_fields("Rigproof board", [&board](FieldVisitor& visitor) { visit_board(visitor, board); },
                          {1, false});
}

bool names_sensor_file(const std::string& sensor) {
  const std::filesystem::path extension = std::filesystem::path(sensor).extension();
  return extension == ".yaml" || extension == ".yml";
}

SensorPreset load_sensor_preset(const std::string& name, const VisitFields& simulation) {
  SensorPreset preset;
  preset.name = name;
  const YamlTree tree =
      read_yaml_file(names_sensor_file(name) ? find_data_file("sensors", name) : find_preset("sensors", name));
  read_fields_of_tree(tree, [&](FieldVisitor& visitor) { visit_preset(visitor, preset, simulation); });
  const YamlTree* block = tree.find("simulation");
  const YamlTree* device = block == nullptr ? nullptr : block->find("depth");
  if (block != nullptr && preset.depth)
    state_depth_bias(device == nullptr ? YamlTree() : *device, preset.stereo, &preset.depth->noise);
  return preset;
}

Board load_board(const std::string& name_or_path) {
  const YamlTree tree = read_yaml_file(find_data_file("boards", name_or_path));
  if (!tree.is_map()) throw Error(tree.file + ": must be a block with squares and square_mm");
  Board board;
  read_fields_of_tree(tree, [&board](FieldVisitor& visitor) { visit_fields(visitor, board); });
  return board;
}

}  // namespace rigproof
