#include "rigproof/study/workflow/kept_observations.h"

#include <link.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <utility>
#include <vector>

#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/observations_text.h"
#include "rigproof/core/text.h"

namespace fs = std::filesystem;

namespace rigproof {
namespace {

constexpr std::size_t kMostKept = 64;
// File systems tell times of change to two seconds at worst.
constexpr std::time_t kSettled_s = 2;

std::optional<std::string> environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

/// Text that tells things apart, grown piece by piece.
class Key {
 public:
  explicit Key(std::time_t now) : now_(now) {}
  Key& add(const std::string& piece) {
    text_ += std::to_string(piece.size()) + ":" + piece;
    return *this;
  }
  Key& add(double value) { return add(number_text(value)); }
  // What changes when another content takes a file's place. False where nobody can be sure of it.
  bool add_file(const fs::path& file) {
    struct stat now = {};
    if (::stat(file.c_str(), &now) != 0) return false;
    add(file.string());
    for (const auto number :
         {static_cast<long long>(now.st_dev), static_cast<long long>(now.st_ino), static_cast<long long>(now.st_size),
          static_cast<long long>(now.st_mtim.tv_sec), static_cast<long long>(now.st_mtim.tv_nsec),
          static_cast<long long>(now.st_ctim.tv_sec), static_cast<long long>(now.st_ctim.tv_nsec)})
      add(std::to_string(number));
    return std::max(now.st_mtim.tv_sec, now.st_ctim.tv_sec) + kSettled_s < now_;
  }
  const std::string& text() const { return text_; }

 private:
  std::time_t now_;
  std::string text_;
};

// The program and what it has loaded: corners and pictures are found by libraries, too.
bool add_program(Key* key) {
  std::vector<std::string> files = {program_file().string()};
  dl_iterate_phdr(
      [](dl_phdr_info* loaded, std::size_t, void* to) {
        const std::string file = loaded->dlpi_name;
        if (file.find('/') != std::string::npos) static_cast<std::vector<std::string>*>(to)->push_back(file);
        return 0;
      },
      &files);
  return std::all_of(files.begin(), files.end(), [key](const std::string& file) { return key->add_file(file); });
}

bool add_frame(const fs::path& folder, const CameraFrame& frame, Key* key) {
  key->add(frame.stamp_s).add(frame.exposure_s);
  for (const std::string& file : {frame.color_file, frame.depth_file, frame.cloud_file}) {
    key->add(file);
    if (!file.empty() && !key->add_file(folder / file)) return false;
  }
  return true;
}

void add_motion(const Recording& recording, Key* key) {
  for (const OdometrySample& sample : recording.odometry)
    key->add(sample.stamp_s).add(sample.x_m).add(sample.y_m).add(sample.yaw_rad);
  for (const RecordingSegment& segment : recording.segments)
    key->add(segment.kind).add(segment.begin_s).add(segment.end_s);
}

constexpr const char* kEnding = ".observations";
fs::path file_of(const std::string& key) { return observations_folder() / (key + kEnding); }

// Nobody else's, should the folder hold other things.
bool is_kept(const fs::directory_entry& entry) {
  const std::string key = entry.path().stem().string();
  return entry.path().extension() == kEnding && entry.is_regular_file() && key.size() == 64 &&
         std::all_of(key.begin(), key.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
}

void forget_oldest(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> kept;
  for (const fs::directory_entry& entry : folder_entries(folder))
    if (is_kept(entry)) kept.emplace_back(entry.last_write_time(), entry.path());
  if (kept.size() <= kMostKept) return;
  std::sort(kept.begin(), kept.end());
  for (std::size_t i = 0; i + kMostKept < kept.size(); ++i) fs::remove(kept[i].second);
}

}  // namespace

fs::path observations_folder() {
  if (const auto chosen = environment("RIGPROOF_OBSERVATIONS")) return *chosen;
  if (const auto caches = environment("XDG_CACHE_HOME"); caches && fs::path(*caches).is_absolute())
    return fs::path(*caches) / "rigproof" / "observations";
  const auto home = environment("HOME");
  return home && fs::path(*home).is_absolute() ? fs::path(*home) / ".cache" / "rigproof" / "observations" : fs::path();
}

std::string observations_key(const Recording& recording, const ObserveOptions& options, std::time_t now) {
  if (observations_folder().empty()) return "";
  std::error_code error;
  const fs::path folder = fs::canonical(recording.folder, error);
  Key key(now);
  if (error || !add_program(&key)) return "";
  key.add(folder.string()).add(rig_text(recording.rig));
  key.add(options.stop_tolerance_s).add(options.max_odometry_gap_s).add(options.use_depth ? 1.0 : 0.0);
  for (const std::vector<CameraFrame>& frames : recording.frames) {
    key.add(static_cast<double>(frames.size()));
    for (const CameraFrame& frame : frames)
      if (!add_frame(folder, frame, &key)) return "";
  }
  add_motion(recording, &key);
  return sha256_hex(key.text());
}

std::optional<Observations> recall_observations(const std::string& key, const Recording& recording) {
  if (key.empty()) return std::nullopt;
  try {
    const fs::path file = file_of(key);
    if (!fs::is_regular_file(file)) return std::nullopt;
    Observations known = load_observations(file);
    // Files leave out what a recording has from elsewhere, as sensors that are files of their own.
    known.source = recording.folder.string();
    known.cameras = recording.rig.cameras;
    known.odometry_noise = recording.rig.odometry_noise;
    known.accept = recording.rig.accept;
    std::error_code ignored;
    fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);  // in use, so that others go first
    return known;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

void keep_observations(const std::string& key, const Observations& observations) {
  if (key.empty()) return;
  try {
    const fs::path file = file_of(key);
    write_file_atomically_unsynced(file, observations_text(observations));
    forget_oldest(file.parent_path());
  } catch (const std::exception&) {
    return;
  }
}

}  // namespace rigproof
