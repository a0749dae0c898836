#include "rigproof/formats/open_input.h"

#include "rigproof/formats/memroc_layout.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

fs::path observations_in(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? path / "observations.json" : path;
}

}  // namespace

Input open_input(const fs::path& path) {
  Input input;
  input.kind = classify_input(path);
  input.path = path;
  switch (input.kind) {
    case InputKind::kRun:
      input.recording = load_recording(RunFolder{path}.recording());
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
