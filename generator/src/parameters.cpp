#include "rigproof/generator/parameters.h"

#include <algorithm>

namespace rigproof {
namespace {

// Keys that begin with one of these need no rendering; all others do, including new ones. Must agree with
// without_sense_keys(), and with docs/guides/generate.md. One of them needs rendering if images are taken at speed.
const char* const kSenseKeys[] = {
    "name",     "stop_period_s", "odometry.",       "sensor_noise", "depth_scale_bias_percent",
    "sensing.", "clouds",        "cloud_stride_px", "png_level"};
const char* const kRenderKeyWhileMoving = "sensing.time.camera_delay_ms";

// Of further boards, what is told of them needs none, either.
const char* const kToldOfBoards = ".told_place_sigma_";

bool is_sense_key(const std::string& path) {
  if (path.rfind("more_boards[", 0) == 0 && path.find(kToldOfBoards) != std::string::npos) return true;
  return std::any_of(std::begin(kSenseKeys), std::end(kSenseKeys), [&path](const char* key) {
    const std::string text = key;
    return text.back() == '.' ? path.rfind(text, 0) == 0 : path == text;
  });
}

}  // namespace

std::vector<Parameter> all_parameters() {
  GenerateConfig config;
  const YamlTree schema = schema_of_block([&config](FieldVisitor& visitor) { config.visit(visitor); });
  std::vector<Parameter> parameters;
  for (const FieldSummary& field : fields_of_schema(schema, false))
    if (!field.is_block)
      parameters.push_back({field.path, is_sense_key(field.path) ? ParameterKind::kSense : ParameterKind::kRender});
  return parameters;
}

std::vector<std::string> changed_render_keys(const GenerateConfig& there, const GenerateConfig& here) {
  std::vector<std::string> keys;
  for (const std::string& difference : differences(there, here)) {
    const std::string path = difference.substr(0, difference.find(':'));
    const bool moves = there.moves_while_exposing() || here.moves_while_exposing();
    if (!is_sense_key(path) || (moves && path == kRenderKeyWhileMoving)) keys.push_back(path);
  }
  return keys;
}

GenerateConfig without_sense_keys(const GenerateConfig& config) {
  const GenerateConfig defaults;
  GenerateConfig rendered = config;
  rendered.name = defaults.name;
  rendered.stop_period_s = defaults.stop_period_s;
  rendered.odometry = defaults.odometry;
  rendered.sensor_noise = defaults.sensor_noise;
  rendered.depth_scale_bias_percent = defaults.depth_scale_bias_percent;
  rendered.sensing = defaults.sensing;
  if (config.moves_while_exposing()) rendered.sensing.time.camera_delay_ms = config.sensing.time.camera_delay_ms;
  rendered.clouds = defaults.clouds;
  rendered.cloud_stride_px = defaults.cloud_stride_px;
  rendered.png_level = defaults.png_level;
  for (BoardConfig& board : rendered.more_boards) {
    board.told_place_sigma_mm = defaults.board.told_place_sigma_mm;
    board.told_place_sigma_deg = defaults.board.told_place_sigma_deg;
  }
  return rendered;
}

}  // namespace rigproof
