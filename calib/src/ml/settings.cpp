#include <algorithm>
#include <filesystem>
#include <utility>

#include "rigproof/calib/ml_settings.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

// Of what is estimated, in the settings' units: a prior that is far sharper than any data drowns them in rounding.
constexpr double kLeastSigma = 1e-3;

bool is_file_name(const std::string& name) {
  return !name.empty() && name.size() < 100 && name[0] != '.' &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.+") ==
             std::string::npos;
}

// "a=1,b=2" as YAML, a line each.
std::string as_yaml(const std::string& text) {
  std::string yaml;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string item = text.substr(begin, end - begin);
    const std::size_t equals = item.find('=');
    if (equals == std::string::npos)
      throw Error(std::string(kMlPrefix) + text + ": \"" + item +
                  "\" must be KEY=VALUE; `rigproof schema ml` lists the keys");
    yaml += item.substr(0, equals) + ": " + item.substr(equals + 1) + "\n";
    begin = end + 1;
  }
  return yaml;
}

}  // namespace

void MlSettings::visit(FieldVisitor& visitor) {
  visitor.field("name", name, TextChoices{},
                "Name of the method in tables and of its result's file; default ml, of a file the file's");
  visitor.field(
      "clock_offset_sigma_ms", clock_offset_sigma_ms, NumberRange{0.0, 1000.0},
      "Each camera's stamps are late or early by about this much against the odometry's: estimated from images "
      "that are taken while the robot moves");
  visitor.field("focal_sigma_percent", focal_sigma_percent, NumberRange{0.0, 20.0},
                "Each camera's focal length is off by about this much: estimated");
  visitor.field("principal_point_sigma_px", principal_point_sigma_px, NumberRange{0.0, 50.0},
                "Each camera's principal point is off by about this much along x and y: estimated");
  visitor.field(
      "rotation_centre_sigma_mm", rotation_centre_sigma_mm, NumberRange{0.0, 1000.0},
      "Odometry along the way: the point about which the robot turns lies off the robot's origin along x by about "
      "this much, which no data tell; 0 where the origin is that point by definition");
  visitor.field("turn_lag_sigma_ms", turn_lag_sigma_ms, NumberRange{0.0, 1000.0},
                "Beside clock offsets: the body turns later than its wheels by about this much (tyres give way): "
                "estimated; 0 where it does not");
  visitor.field("riding_height_sigma_mm", riding_height_sigma_mm, NumberRange{0.0, 100.0},
                "Images taken at speed: the robot rides higher or lower than at rest by about this much, which no data "
                "tell; 0 where it does not");
  for (const auto& [key, sigma] : {std::make_pair("clock_offset_sigma_ms", clock_offset_sigma_ms),
                                   {"focal_sigma_percent", focal_sigma_percent},
                                   {"principal_point_sigma_px", principal_point_sigma_px},
                                   {"turn_lag_sigma_ms", turn_lag_sigma_ms}})
    visitor.check(!(sigma > 0.0) || sigma >= kLeastSigma, key,
                  "allowed is 0 (believed) or " + number_text(kLeastSigma) + " and more");
  visitor.check(is_file_name(name), "name", "must be letters, digits, _, -, + and .");
}

MlOptions MlSettings::options() const {
  MlOptions options;
  options.clock_offset_sigma_s = 1e-3 * clock_offset_sigma_ms;
  options.turn_lag_sigma_s = 1e-3 * turn_lag_sigma_ms;
  options.riding_height_sigma_m = 1e-3 * riding_height_sigma_mm;
  options.focal_relative_sigma = 0.01 * focal_sigma_percent;
  options.principal_point_sigma_px = principal_point_sigma_px;
  options.rotation_centre_sigma_m = 1e-3 * rotation_centre_sigma_mm;
  return options;
}

bool names_ml_file(const std::string& text) { return text.find('=') == std::string::npos; }

MlSettings read_ml_settings(const std::string& text) {
  MlSettings settings;
  const VisitFields visit = [&settings](FieldVisitor& visitor) { settings.visit(visitor); };
  if (!names_ml_file(text)) {
    read_fields_from_text(as_yaml(text), kMlPrefix + text, visit);
    return settings;
  }
  if (text.empty()) throw Error(std::string(kMlPrefix) + ": KEY=VALUE,.. or a YAML file must follow");
  settings.name = std::filesystem::path(text).stem().string();
  read_fields(text, visit);
  return settings;
}

std::string ml_settings_schema() {
  MlSettings settings;
  return schema_of_fields("Rigproof settings of ml", [&settings](FieldVisitor& visitor) { settings.visit(visitor); });
}

MethodTraits MlMethod::traits() const {
  return {settings_.name,
          "Maximum likelihood of cameras, board, robot poses and nuisances together, with its uncertainty",
          "board, odometry; ground planes for the height", "camera to robot (6), camera to camera (6), covariance"};
}

Result MlMethod::solve(const Observations& observations) const {
  Result result = estimate_maximum_likelihood(observations, settings_.options()).result;
  result.method = settings_.name;
  return result;
}

std::string MlMethod::settings_text() const {
  MlSettings settings = settings_;
  return write_fields([&settings](FieldVisitor& visitor) { settings.visit(visitor); });
}

const Method& ml_method() {
  static const MlMethod method;
  return method;
}

}  // namespace rigproof
