// A run as `rigproof generate` leaves it.
#include "rigproof/formats/format.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// A run whose manifest is lost is one, too.
bool is_run(const fs::path& folder) { return has_file(folder, "run.yaml") || has_file(folder, "recording/rig.yaml"); }

// Observations replace the images where a run was copied without them.
Input read_run(const fs::path& folder) {
  Input input;
  input.run = RunFolder{folder};
  std::error_code ignored;
  if (!fs::exists(input.run->recording(), ignored) && fs::exists(input.run->observations_file(), ignored))
    input.observations = load_observations(input.run->observations_file());
  else
    input.recording = load_recording(input.run->recording());
  return input;
}

}  // namespace

Format run_format() {
  Format format;
  format.name = "run";
  format.what = format.given_as = "a run";
  format.marker = "run.yaml";
  format.detect = is_run;
  format.read = read_run;
  return format;
}

}  // namespace rigproof
