// Bare observations: the file itself, or a folder that holds it.
#include "rigproof/formats/format.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

const char* const kMarker = "observations.json";

bool holds_observations(const fs::path& folder) { return has_file(folder, kMarker); }

Input read_observations(const fs::path& path) {
  std::error_code ignored;
  Input input;
  input.observations = load_observations(fs::is_directory(path, ignored) ? path / kMarker : path);
  return input;
}

}  // namespace

Format observations_format() {
  Format format;
  format.name = format.what = "observations";
  format.given_as = "an observations.json";
  format.marker = kMarker;
  format.suffix = ".json";
  format.has_images = false;
  format.detect = holds_observations;
  format.read = read_observations;
  return format;
}

}  // namespace rigproof
