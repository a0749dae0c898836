#include "observing.h"

#include <malloc.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <utility>

#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/core/error.h"
#include "rigproof/study/workflow/kept_observations.h"
#include "rigproof/study/workflow/workflow.h"
#include "rigproof/words/sentences.h"

namespace rigproof {

std::filesystem::path product_place(const Input& input, const std::filesystem::path& output, const std::string& name) {
  if (!output.empty()) return output;
  const std::filesystem::path folder = product_folder(input);
  if (::access(folder.c_str(), W_OK) != 0)
    throw Error(folder.string() + ": cannot be written; choose another folder with --output");
  return folder / name;
}

Vision::Vision(const VisionArguments& arguments)
    : ground(arguments.ground), features(feature_source_by_name(arguments.features)) {
  if (!arguments.horizon.empty()) horizon = horizon_source_by_name(arguments.horizon);
}

Observations observe_with_progress(const Input& input, int jobs, const Terminal& terminal) {
  ObserveOptions options;
  options.threads = jobs;
  const std::string key = input.observations ? "" : observations_key(input.recording.value(), options);
  if (!key.empty())
    if (std::optional<Observations> known = recall_observations(key, *input.recording)) {
      terminal.line(
          "The images are as they were when they were last looked at: not looked at again "
          "(to do so, set RIGPROOF_OBSERVATIONS to nothing).");
      return *std::move(known);
    }
  ProgressLine progress(terminal, "observe", "images");
  options.progress = progress.callback();
  Observations observations = observations_of(input, options);
  if (interrupted()) throw Error("interrupted", ExitCode::kTryAgain);
  keep_observations(key, observations);
  return observations;
}

std::optional<Observations> observed_before(const Input& input) {
  if (!input.recording) return std::nullopt;
  return recall_observations(observations_key(*input.recording, {}), *input.recording);
}

Observations observe_with_progress(const Input& input, const Vision& vision, int jobs, const Terminal& terminal) {
  const GroundSource source = ground_source_by_name(vision.ground);
  if (source == GroundSource::kImages && !input.recording)
    throw Error(input.path.string() + ": --ground images needs images, but the input holds observations only");
  Observations observations = observe_with_progress(input, jobs, terminal);
  ProgressLine progress(terminal, "ground", "images");
  MethodInput images = method_input(input, observations, vision, jobs);
  images.progress = progress.callback();
  for (const Finding& finding : take_ground_from(source, images, &observations).findings)
    terminal.line(words::sentence_of(finding));
  return observations;
}

std::string result_name(const std::string& method, const VisionArguments& vision) {
  const VisionArguments usual;
  std::vector<std::pair<std::string, std::string>> unusual;
  const auto add = [&unusual](const char* option, const std::string& given, const std::string& by_default) {
    if (given == by_default) return;  // of "onnx:FILE" the file's own name
    unusual.emplace_back(option, std::filesystem::path(given.substr(given.find(':') + 1)).stem().string());
  };
  add("ground", vision.ground, usual.ground);
  add("features", vision.features, usual.features);
  add("horizon", vision.horizon, usual.horizon);
  return name_with_settings(method, unusual);
}

MethodInput method_input(const Input& input, const Observations& observations, const Vision& vision, int jobs) {
  return {observations,
          input.recording ? &*input.recording : nullptr,
          jobs,
          vision.features.get(),
          vision.horizon.get(),
          {},
          nullptr,
          [] { return !interrupted(); }};
}

namespace {

// The equations of 100,000 stops take blocks of 100 MB, again at each step: given back to the system each time, they
// cost as much as the mathematics.
void keep_large_blocks() {
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, -1);
}

}  // namespace

Result run_with_progress(const Method& method, MethodInput input, const Terminal& terminal) {
  ProgressLine progress(terminal, method.traits().name, "images");
  input.progress = progress.callback();
  keep_large_blocks();
  return run_method(method, input);
}

}  // namespace rigproof
