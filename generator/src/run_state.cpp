#include "run_state.h"

#include <algorithm>
#include <sstream>
#include <system_error>
#include <utility>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "rigproof/generator/generator_version.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// A killed generation loses at most what was rendered since the last write of the manifest.
constexpr double kWritePeriodS = 2.0;
// Writing the manifest may take this share of the time. Syncing of files does not count: it has to be done once, and
// the longer it is put off, the more of them wait for it.
constexpr double kWriteShare = 0.05;

const char* const kInputMark = "# input ";

// Everything but the manifest that a generation or a calibration writes into a run, what was made of others first.
std::vector<fs::path> made_paths(const RunFolder& run) {
  return {run.root / "report.html", run.results(), run.root / "findings", run.observations_file(),
          run.pictures(),           run.truth(),   run.recording()};
}

bool is_temporary(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.size() > 4 && name.front() == '.' && name.compare(name.size() - 4, 4, ".tmp") == 0;
}

std::string first_foreign_entry(const fs::path& folder) {
  for (const fs::directory_entry& entry : folder_entries(folder)) {
    if (!is_temporary(entry.path())) return entry.path().filename().string();
  }
  return "";
}

std::vector<std::string> input_lines(const std::string& config_text) {
  std::vector<std::string> lines;
  std::istringstream in(config_text);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(kInputMark, 0) == 0) lines.push_back(line.substr(std::string(kInputMark).size()));
  }
  return lines;
}

// "rigs/a.yaml has changed" for every preset that differs between two texts of config.yaml.
std::vector<std::string> input_differences(const std::string& there, const std::string& here) {
  const std::vector<std::string> old_lines = input_lines(there);
  std::vector<std::string> result;
  for (const std::string& line : input_lines(here)) {
    if (std::find(old_lines.begin(), old_lines.end(), line) != old_lines.end()) continue;
    result.push_back(line.substr(line.find(' ') + 1) + " has changed");
  }
  return result;
}

std::vector<std::string> config_differences(const RunFolder& run, const Scenario& scenario) {
  try {
    const std::string there = read_text_file(run.config_file());
    std::vector<std::string> result = differences(parse_generate_config(there, run.config_file()), scenario.config);
    const std::vector<std::string> inputs = input_differences(there, config_file_text(scenario));
    result.insert(result.end(), inputs.begin(), inputs.end());
    return result;
  } catch (const Error&) {
    return {};  // missing or unreadable: the hashes differ, that is all that can be said
  }
}

[[noreturn]] void refuse_other(const RunFolder& run, const std::string& what) {
  throw Error(run.root.string() + ": holds a run " + what + "; choose another folder, or start over with --fresh");
}

void check_same(const RunFolder& run, const Scenario& scenario, const Manifest& there, const Manifest& here) {
  if (there.tool_version != here.tool_version) {
    refuse_other(run, "of rigproof " + there.tool_version + ", this is " + here.tool_version);
  }
  if (there.mujoco_version != here.mujoco_version) {
    refuse_other(run, "made with MuJoCo " + there.mujoco_version + ", this is " + here.mujoco_version);
  }
  if (there.config_sha256 == here.config_sha256) return;
  std::vector<std::string> what = config_differences(run, scenario);
  constexpr std::size_t kMost = 5;
  const std::size_t count = what.size();
  what.resize(std::min(count, kMost));
  refuse_other(run, "of another configuration" + (what.empty() ? "" : " (" + joined(what, "; ") + ")") +
                        (count > kMost ? " and " + std::to_string(count - kMost) + " more" : ""));
}

void remove_made(const RunFolder& run) {
  for (const fs::path& path : made_paths(run)) remove_tree(path);
}

// In pieces, since a path takes several times the memory of its text.
void sync_in_pieces(const fs::path& root, const std::vector<std::string>& files) {
  constexpr std::size_t kPiece = 500;
  std::vector<fs::path> piece;
  for (std::size_t i = 0; i < files.size(); ++i) {
    piece.push_back(root / files[i]);
    if (piece.size() < kPiece && i + 1 < files.size()) continue;
    sync_files(piece);
    piece.clear();
  }
}

// Syncs the files, then writes the manifest, beside whatever else goes on; gives the seconds that the manifest took.
std::future<double> write_aside(const RunFolder& run, const Manifest& manifest, std::vector<std::string> unsynced) {
  return std::async(std::launch::async, [run, &manifest, unsynced = std::move(unsynced)] {
    sync_in_pieces(run.root, unsynced);
    const auto start = Clock::now();
    save_manifest(manifest, run.manifest_file());
    return std::chrono::duration<double>(Clock::now() - start).count();
  });
}

}  // namespace

std::string config_file_text(const Scenario& scenario) {
  std::string text = std::string("# resolved by rigproof ") + version() + "; generates the same run again\n";
  for (const ScenarioInput& input : scenario.inputs) text += kInputMark + input.sha256 + " " + input.name + "\n";
  return text + resolved_text(scenario.config);
}

Manifest open_run(const RunFolder& run, const Scenario& scenario, bool fresh) {
  Manifest here;
  here.tool_version = generator_version();
  here.mujoco_version = World::mujoco_version();
  here.config_sha256 = sha256_hex(config_file_text(scenario));
  if (!fs::exists(run.manifest_file())) {
    const std::string foreign = first_foreign_entry(run.root);
    if (foreign.empty()) return here;
    throw Error(run.root.string() + ": is not a run (it holds " + for_message(foreign) +
                " and no run.yaml); choose an empty or a new folder");
  }
  // From here on nothing of it is known: where something cannot be removed, a run is left that can go on.
  if (fresh) save_manifest(here, run.manifest_file());
  const Manifest there = load_manifest(run.manifest_file());
  if (!fresh) check_same(run, scenario, there, here);
  if (!there.complete && there.files.empty() && there.not_kept.empty()) remove_made(run);
  return there;
}

void drop_damaged(const RunFolder& run, Manifest* manifest) {
  for (auto it = manifest->files.begin(); it != manifest->files.end();) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(run.root / it->first, error);
    it = !error && size == it->second.size_bytes ? std::next(it) : manifest->files.erase(it);
  }
}

void remove_temporary_files(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> leftovers;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (is_temporary(it->path()) && it->is_regular_file(error)) leftovers.push_back(it->path());
  }
  for (const fs::path& file : leftovers) fs::remove(file, error);
}

ManifestKeeper::ManifestKeeper(RunFolder run, Manifest manifest)
    : run_(std::move(run)),
      manifest_(std::move(manifest)),
      gl_renderer_(manifest_.gl_renderer),
      next_write_(Clock::now()) {}

ManifestKeeper::~ManifestKeeper() {
  if (write_.valid()) write_.wait();
}

void ManifestKeeper::add(const FileEntries& entries) {
  for (const auto& [path, entry] : entries) new_files_[path] = entry;
}

void ManifestKeeper::add_not_kept(const FileEntries& entries) {
  for (const auto& [path, entry] : entries) new_not_kept_[path] = entry;
}

std::vector<std::string> ManifestKeeper::take_up_news() {
  std::vector<std::string> unsynced;
  manifest_.gl_renderer = gl_renderer_;
  for (auto& [path, entry] : std::exchange(new_not_kept_, {})) manifest_.not_kept[path] = std::move(entry);
  for (auto& [path, entry] : std::exchange(new_files_, {})) {
    manifest_.files[path] = std::move(entry);
    manifest_.not_kept.erase(path);
    unsynced.push_back(path);
  }
  return unsynced;
}

void ManifestKeeper::tick() {
  if (write_.valid()) {
    if (write_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    const double period_s = std::max(kWritePeriodS, write_.get() / kWriteShare);
    next_write_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period_s));
  }
  const bool has_news = !new_files_.empty() || !new_not_kept_.empty();
  if (!has_news || Clock::now() < next_write_) return;
  write_ = write_aside(run_, manifest_, take_up_news());
}

void ManifestKeeper::finish(bool complete) {
  if (write_.valid()) write_.get();
  manifest_.complete = complete;
  write_aside(run_, manifest_, take_up_news()).get();
}

}  // namespace rigproof
