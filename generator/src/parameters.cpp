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

std::string text_of(const Distribution& distribution) {
  const double* constant = std::get_if<double>(&distribution.kind());
  if (constant != nullptr) return number_text(*constant);
  return "drawn, " + number_text(distribution.lowest()) + " to " + number_text(distribution.highest());
}

class Collector : public FieldVisitor {
 public:
  std::vector<Parameter> parameters;

  void field(const char* key, double& value, const NumberRange&, const char* description) override {
    add(key, number_text(value), description);
  }
  void field(const char* key, std::int64_t& value, const NumberRange&, const char* description) override {
    add(key, std::to_string(value), description);
  }
  void field(const char* key, bool& value, const char* description) override {
    add(key, value ? "true" : "false", description);
  }
  void field(const char* key, std::string& value, const TextChoices&, const char* description) override {
    add(key, value.empty() ? "empty" : value, description);
  }
  void field(const char* key, Distribution& value, const NumberRange&, const char* description) override {
    add(key, text_of(value), description);
  }
  void field(const char* key, std::vector<double>& value, const NumberRange&, std::size_t, std::size_t,
             const char* description) override {
    std::vector<std::string> words;
    for (const double number : value) words.push_back(number_text(number));
    add(key, "[" + joined(words) + "]", description);
  }
  void field(const char* key, std::vector<std::string>& value, const char* description) override {
    add(key, "[" + joined(value) + "]", description);
  }
  void section(const char* key, const std::function<void(FieldVisitor&)>& visit, const char*) override {
    const std::string outer = path_;
    path_ += std::string(key) + ".";
    visit(*this);
    path_ = outer;
  }
  // One row for a list: its elements have no defaults.
  void list(const char* key, const std::function<std::size_t()>&, const std::function<void(std::size_t)>&,
            const std::function<void(std::size_t, FieldVisitor&)>&, const char* description) override {
    add(key, "none", description);
  }
  void check(bool, const char*, const std::string&) override {}

 private:
  void add(const char* key, const std::string& value, const char* description) {
    const std::string path = path_ + key;
    parameters.push_back(
        {path, is_sense_key(path) ? ParameterKind::kSense : ParameterKind::kRender, value, description});
  }

  std::string path_;
};

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
  Collector collector;
  config.visit(collector);
  return collector.parameters;
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
