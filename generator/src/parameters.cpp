#include "rigproof/generator/parameters.h"

#include <algorithm>

#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// What begins with one of these is no matter of rendering; everything else is, new fields included. As
// without_sense_keys() has them. Where images are taken while the robot moves one of them is, nevertheless.
const char* const kSenseKeys[] = {
    "name",     "stop_period_s", "odometry.",       "sensor_noise", "depth_scale_bias_percent",
    "sensing.", "clouds",        "cloud_stride_px", "png_level"};
const char* const kRenderKeyWhileMoving = "sensing.time.camera_delay_ms";

bool is_sense_key(const std::string& path) {
  return std::any_of(std::begin(kSenseKeys), std::end(kSenseKeys), [&path](const char* key) {
    const std::string text = key;
    return text.back() == '.' ? path.rfind(text, 0) == 0 : path == text;
  });
}

std::string table_of(const std::vector<Parameter>& parameters, ParameterKind kind) {
  std::string text = "| key | default | meaning |\n|---|---|---|\n";
  for (const Parameter& parameter : parameters) {
    if (parameter.kind != kind) continue;
    text += "| `" + parameter.path + "` | " + parameter.default_value + " | " + parameter.description + " |\n";
  }
  return text;
}

}  // namespace

std::vector<Parameter> all_parameters() {
  GenerateConfig config;
  const YamlTree schema = schema_of_block([&config](FieldVisitor& visitor) { config.visit(visitor); });
  std::vector<Parameter> parameters;
  // One row for a list: its elements have no defaults.
  for (const FieldSummary& field : fields_of_schema(schema, false))
    if (!field.is_block)
      parameters.push_back({field.path, is_sense_key(field.path) ? ParameterKind::kSense : ParameterKind::kRender,
                            field.default_text.empty() ? "none" : field.default_text, field.description});
  return parameters;
}

std::string parameter_tables() {
  const std::vector<Parameter> parameters = all_parameters();
  return "### Render keys\n\n" + table_of(parameters, ParameterKind::kRender) + "\n### Sense keys\n\n" +
         table_of(parameters, ParameterKind::kSense);
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
  return rendered;
}

}  // namespace rigproof
