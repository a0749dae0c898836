#include <algorithm>
#include <filesystem>
#include <utility>

#include "rigproof/calib/diagnose/ml_settings.h"
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

// "ml-told_exact", by what was asked for: also a usual value may differ from what a rig states.
std::string derived_name(const MlSettings& settings) {
  std::vector<std::pair<std::string, std::string>> asked;
  for (std::size_t i = 0; i < settings.sigmas.size(); ++i)
    if (settings.asked[i]) asked.emplace_back(prior_settings()[i].key, number_text(settings.sigmas[i]));
  if (settings.believe_told) asked.emplace_back("told", "exact");
  std::sort(asked.begin(), asked.end());
  return name_with_settings(MlSettings().name, asked);
}

}  // namespace

MlSettings::MlSettings() {
  const PriorSigmas usual = usual_priors();
  for (const PriorSetting& setting : prior_settings()) sigmas.push_back(usual.*setting.sigma * setting.units_per_si);
  asked.assign(sigmas.size(), false);
}

void MlSettings::visit(FieldVisitor& visitor) {
  visitor.field("name", name, TextChoices{},
                "Name of the method in tables and of its result's file; default ml with what is set, as "
                "ml-told_exact; of a file the file's");
  visitor.choice("told", believe_told, {{"as_stated", false}, {"exact", true}},
                 "exact: lenses and board are believed to the last digit, whatever sigmas the rig states of them");
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    const PriorSetting& setting = prior_settings()[i];
    visitor.field(setting.key, sigmas[i], NumberRange{0.0, setting.most}, setting.description);
    visitor.check(!setting.estimated || !(sigmas[i] > 0.0) || sigmas[i] >= kLeastSigma, setting.key,
                  "allowed is 0 (believed) or " + number_text(kLeastSigma) + " and more");
    if (visitor.given(setting.key) != nullptr) asked[i] = true;
  }
  visitor.check(is_file_name(name), "name", "must be letters, digits, _, -, + and .");
}

MlOptions MlSettings::options() const {
  MlOptions options;
  options.priors.believe_told = believe_told;
  for (std::size_t i = 0; i < sigmas.size(); ++i) {
    const PriorSetting& setting = prior_settings()[i];
    if (!asked[i]) continue;
    options.priors.*setting.sigma = sigmas[i] / setting.units_per_si;
    options.priors.asked.push_back(setting.sigma);
  }
  return options;
}

bool names_ml_file(const std::string& text) { return text.find('=') == std::string::npos; }

MlSettings read_ml_settings(const std::string& text) {
  MlSettings settings;
  bool is_named = false;
  const VisitFields visit = [&](FieldVisitor& visitor) {
    settings.visit(visitor);
    is_named = visitor.given("name") != nullptr;
  };
  if (!names_ml_file(text)) {
    read_fields_from_text(as_yaml(text), kMlPrefix + text, visit);
    if (!is_named) settings.name = derived_name(settings);
    return settings;
  }
  if (text.empty()) throw Error(std::string(kMlPrefix) + ": KEY=VALUE,.. or a YAML file must follow");
  settings.name = std::filesystem::path(text).stem().string();
  read_fields(text, visit);
  return settings;
}

std::string ml_settings_schema() { return schema_of<MlSettings>("Rigproof settings of ml"); }

MethodTraits MlMethod::traits() const {
  return {settings_.name,
          "Maximum likelihood of cameras, board, robot poses and nuisances together, with its uncertainty",
          "board, odometry; ground planes for the height",
          "camera to robot (6), camera to camera (6), covariance",
          MethodReads::kObservations,
          5e-4,
          true};
}

Result MlMethod::solve(const Observations& observations) const {
  Result result = estimate_maximum_likelihood(observations, settings_.options()).result;
  result.method = settings_.name;
  return result;
}

// What was asked for differs from what a rig may state otherwise, also where it is the usual value.
std::string MlMethod::settings_text() const {
  std::string text = emit_yaml(tree_of(settings_));
  for (std::size_t i = 0; i < settings_.asked.size(); ++i)
    if (settings_.asked[i]) text += std::string("# asked for: ") + prior_settings()[i].key + "\n";
  return text;
}

const Method& ml_method() {
  static const MlMethod method;
  return method;
}

}  // namespace rigproof
