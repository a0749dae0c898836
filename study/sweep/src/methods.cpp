#include "methods.h"

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>
#include <set>

#include "cache.h"
#include "rigproof/calib/diagnose/ml_settings.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/study/workflow/external.h"
#include "work.h"

namespace rigproof {
namespace {

// Threads that a network started would not be in the processes that are forked later.
class OneThread {
 public:
  OneThread() : before_(cv::getNumThreads()) { cv::setNumThreads(1); }
  ~OneThread() { cv::setNumThreads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

// With the content of its networks, which are opened so that a wrong one is told at once.
std::string hash_of(const SweepVision& vision) {
  const OneThread alone;
  const SweepSight sight(vision);
  std::string text = vision.text();
  for (const std::string& source : {vision.features, vision.horizon}) {
    const std::size_t colon = source.find(':');
    if (colon != std::string::npos) text += " " + sha256_hex_of_file(source.substr(colon + 1));
  }
  return sha256_hex(text);
}

// A file by its absolute path: a sweep may go on from another folder.
std::string with_absolute_path(const std::string& spec) {
  const std::string external = kExternal, ml = kMlPrefix;
  const auto absolute = [](const std::filesystem::path& file) {
    return std::filesystem::absolute(file).lexically_normal().string();
  };
  if (spec.rfind(ml, 0) == 0) {
    const std::string settings = spec.substr(ml.size());
    return names_ml_file(settings) ? ml + absolute(settings) : spec;
  }
  if (spec.rfind(external, 0) == 0) return external + absolute(spec.substr(external.size()));
  const std::filesystem::path file = spec;
  return file.extension() == ".yaml" || file.extension() == ".yml" ? external + absolute(file) : spec;
}

SweepMethod sweep_method(const SweepMethodChoice& choice) {
  const std::shared_ptr<const Method> method = methods_by_name({choice.method}).front();
  const MethodTraits traits = method->traits();
  SweepMethod entry;
  entry.spec = choice.method;
  entry.name = choice.name.empty() ? traits.name : choice.name;
  entry.vision = choice.vision;
  entry.reads_images = traits.reads != MethodReads::kObservations;
  entry.seconds_a_view = traits.seconds_a_view;
  entry.matches_features = traits.reads == MethodReads::kFeatures || choice.vision.ground == "images";
  entry.outside = choice.method.rfind(kExternal, 0) == 0;
  const std::string settings = method->settings_text();
  entry.hash = entry.outside ? settings : settings.empty() ? program_hash() : sha256_hex(program_hash() + settings);
  entry.stored = traits.name;
  if (!choice.name.empty()) entry.hash = sha256_hex(entry.hash + " " + choice.method);
  if (choice.vision.text() == SweepVision().text()) return entry;
  entry.reads_images = entry.reads_images || choice.vision.ground != SweepVision().ground;
  const std::string vision = hash_of(choice.vision);
  entry.hash = sha256_hex(entry.hash + " " + vision);
  entry.stored += " " + vision;
  return entry;
}

}  // namespace

std::vector<std::string> with_added(std::vector<std::string> there, const std::vector<std::string>& more) {
  for (const std::string& spec : more) {
    const std::string added = with_absolute_path(spec);
    if (std::find(there.begin(), there.end(), added) == there.end()) there.push_back(added);
  }
  return there;
}

std::vector<SweepMethod> sweep_methods(const SweepConfig& config, const std::vector<std::string>& added) {
  std::vector<SweepMethodChoice> choices = config.methods;
  for (const std::string& spec : added) {
    const auto same = [&spec](const SweepMethodChoice& choice) { return choice.label() == spec; };
    if (std::none_of(choices.begin(), choices.end(), same)) choices.push_back({spec, {}, config.vision});
  }
  std::vector<SweepMethod> methods;
  std::set<std::string> names;
  for (const SweepMethodChoice& choice : choices) {
    methods.push_back(sweep_method(choice));
    if (!names.insert(methods.back().name).second)
      throw Error(choice.method + ": there are two methods of the name " + methods.back().name);
  }
  return methods;
}

std::optional<Finding> why_no_ground(const SweepVision& vision, bool has_images) {
  if (vision.ground != "images" || has_images) return std::nullopt;
  return Finding("method.no_images_of_ground");
}

}  // namespace rigproof
