#include "rigproof/formats/open_input.h"

#include "rigproof/formats/memroc_layout.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

fs::path observations_in(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? path / "observations.json" : path;
}

// Observations replace the images where a run was copied without them.
void open_run(const RunFolder& run, Input* input) {
  std::error_code ignored;
  if (!fs::exists(run.recording(), ignored) && fs::exists(run.observations_file(), ignored))
    input->observations = load_observations(run.observations_file());
  else
    input->recording = load_recording(run.recording());
}

}  // namespace

Input open_input(const fs::path& path) {
  Input input;
  input.kind = classify_input(path);
  input.path = path;
  switch (input.kind) {
    case InputKind::kRun:
      open_run(RunFolder{path}, &input);
      break;
    case InputKind::kRecording:
      input.recording = load_recording(path);
      break;
    case InputKind::kMemrocLayout:
      input.recording = load_memroc_layout(path);
      break;
    case InputKind::kObservations:
      input.observations = load_observations(observations_in(path));
      break;
  }
  return input;
}

}  // namespace rigproof
