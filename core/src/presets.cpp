// Presets of sensors and boards.
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/rig_yaml.h"

namespace rigproof {
namespace {

// {width_px, height_px, hfov_deg}: square pixels, centred; or full intrinsics.
Camera read_nominal_camera(MapReader& map) {
  if (!map.has("hfov_deg")) return read_intrinsics(map);
  // One that is refused was given all the same: no other intrinsics are missing.
  const double field_of_view = map.number("hfov_deg", {1.0, 170.0}).value_or(90.0);
  map.require("width_px", "the width of the image in pixels");
  map.require("height_px", "the height of the image in pixels");
  const int width = static_cast<int>(map.integer("width_px", {1.0, 32768.0}).value_or(1));
  const int height = static_cast<int>(map.integer("height_px", {1.0, 32768.0}).value_or(1));
  const double focal_px = 0.5 * width / std::tan(0.5 * deg_to_rad(field_of_view));
  // Whole where it is meant to be: 640, not 640.0000000000001.
  return Camera::symmetric(width, height, std::round(focal_px * 1e6) * 1e-6);
}

// What the data sheet of a stereo camera gives: sigma of 1/z = s / (f B).
std::optional<StereoGeometry> read_stereo_geometry(const YamlTree& tree, const std::string& path, Problems* problems) {
  MapReader map(tree, path, problems);
  for (const char* key : {"width_px", "hfov_deg", "baseline_m", "disparity_sigma_px"}) map.require(key, "a number");
  const auto width = map.number("width_px", {1.0, 32768.0});
  const auto field_of_view = map.number("hfov_deg", {1.0, 170.0});
  const auto baseline = map.number("baseline_m", {1e-4, 10.0});
  const auto sigma = map.number("disparity_sigma_px", {1e-4, 10.0});
  map.finish();
  if (!width || !field_of_view || !baseline || !sigma) return std::nullopt;
  return StereoGeometry{0.5 * *width / std::tan(0.5 * deg_to_rad(*field_of_view)), *baseline, *sigma};
}

// {width_px, height_px, hfov_deg, T_color_depth}, or full intrinsics.
DepthStream::OwnCamera read_raw_depth(const YamlTree& tree, Problems* problems) {
  MapReader map(tree, "depth.raw", problems);
  DepthStream::OwnCamera raw;
  raw.camera = read_nominal_camera(map);
  map.require("T_color_depth", "{translation_m, quaternion_xyzw}");
  if (const YamlTree* transform = map.find("T_color_depth")) {
    MapReader block(*transform, "depth.raw.T_color_depth", problems);
    raw.T_color_depth = read_transform(block);
    block.finish();
  }
  map.finish();
  return raw;
}

void read_preset_depth(const YamlTree& tree, Problems* problems, SensorPreset* preset) {
  MapReader map(tree, "depth", problems);
  DepthStream defaults;
  if (const YamlTree* stereo = map.find("stereo"))
    preset->stereo = read_stereo_geometry(*stereo, "depth.stereo", problems);
  if (preset->stereo) {
    const StereoGeometry& stereo = *preset->stereo;
    defaults.noise.law = DepthNoise::Law::kStereo;
    defaults.noise.inverse_depth_sigma_per_m = stereo.disparity_sigma_px / (stereo.focal_px * stereo.baseline_m);
  }
  preset->depth = read_depth_stream(map, defaults);
  if (const YamlTree* raw = map.find("raw")) preset->raw_depth = read_raw_depth(*raw, problems);
  map.finish();
}

// A real device of this kind has the fixed error that a simulated one may have; a block `noise` that states it
// prevails.
void state_depth_bias(const DepthSimulation& device, const std::optional<StereoGeometry>& stereo, DepthNoise* noise) {
  if (noise->has_bias()) return;
  if (stereo) noise->bias_inverse_depth_per_m = device.bias_px / (stereo->focal_px * stereo->baseline_m);
  if (noise->law == DepthNoise::Law::kTimeOfFlight) noise->bias_m = device.bias_m;
  noise->bias_cell_deg = device.bias_cell_deg;
}

}  // namespace

SensorPreset load_sensor_preset(const std::string& name) {
  const YamlTree tree = read_yaml_file(find_preset("sensors", name));
  Problems problems;
  MapReader map(tree, "", &problems);
  SensorPreset preset;
  preset.name = name;
  preset.description = map.text("description").value_or("");
  map.texts("sources");
  map.require("color", "a block of intrinsics");
  if (const YamlTree* color = map.find("color")) {
    MapReader block(*color, "color", &problems);
    preset.camera = read_nominal_camera(block);
    block.finish();
  }
  const YamlTree* depth = map.find("depth");
  if (depth != nullptr && depth->is_map()) read_preset_depth(*depth, &problems, &preset);
  preset.delivers_raw_depth = map.text("depth_frame", {"registered", "raw"}).value_or("registered") == "raw";
  if (preset.delivers_raw_depth && !preset.raw_depth)
    map.problem("depth_frame", "raw needs a block depth.raw: {width_px, height_px, hfov_deg, T_color_depth}");
  if (depth != nullptr && !depth->is_map() && depth->scalar != "none") map.problem("depth", "must be none or a block");
  if (const YamlTree* simulation = map.find("simulation")) {
    read_fields_of_block(*simulation, "simulation", &problems,
                         [&preset](FieldVisitor& visitor) { preset.simulation.visit(visitor); });
    if (preset.depth) state_depth_bias(preset.simulation.depth, preset.stereo, &preset.depth->noise);
  }
  map.finish("x-");
  problems.sort();
  problems.throw_if_any();
  return preset;
}

Board load_board(const std::string& name_or_path) {
  Problems problems;
  const YamlTree tree = read_yaml_file(find_data_file("boards", name_or_path));
  if (!tree.is_map()) throw Error(tree.file + ": must be a block with squares and square_mm");
  const Board board = read_board(tree, "", &problems);
  problems.throw_if_any();
  return board;
}

}  // namespace rigproof
