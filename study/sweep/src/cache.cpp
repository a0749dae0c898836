#include "cache.h"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <vector>

#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folder_lock.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxFindingBytes = 16U << 20U;
constexpr const char* kRecording = "recording/";

bool is_file(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

// The whole file; nothing where it cannot be read.
std::optional<std::string> bytes_of_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
  if (size < 0 || static_cast<std::uintmax_t>(size) > kMaxFindingBytes) return std::nullopt;
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), size)) return std::nullopt;
  return bytes;
}

bool is_image(const std::string& path) {
  return path.find("/color/") != std::string::npos || path.find("/depth/") != std::string::npos ||
         path.find("/cloud/") != std::string::npos;
}

struct Deletable {
  fs::file_time_type used;
  std::uint64_t bytes = 0;
  std::vector<fs::path> files;
  std::string set;  ///< empty = a clean render
};

void add_file(const fs::path& file, Deletable* to) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) return;
  to->bytes += size;
  to->files.push_back(file);
}

std::vector<Deletable> clean_renders_in(const fs::path& folder) {
  std::vector<Deletable> found;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (!it->is_regular_file(error)) continue;
    Deletable& render = found.emplace_back();
    render.used = fs::last_write_time(it->path(), error);
    add_file(it->path(), &render);
  }
  return found;
}

/// Which file it was, by what changes when another one takes its place.
struct ReadManifest {
  ino_t file = 0;
  off_t bytes = 0;
  timespec written = {};
  Manifest manifest;
};

// A task asks for the manifest of its run half a dozen times, and reading one takes longer than most methods do.
Manifest manifest_of(const RunFolder& run) {
  static std::mutex mutex;
  static std::map<std::string, ReadManifest> known;
  const std::string file = run.manifest_file().string();
  struct stat now = {};
  if (stat(file.c_str(), &now) != 0) return load_manifest(file);
  const std::lock_guard<std::mutex> guard(mutex);
  ReadManifest& read = known[file];
  const bool same = read.file == now.st_ino && read.bytes == now.st_size && read.written.tv_sec == now.st_mtim.tv_sec &&
                    read.written.tv_nsec == now.st_mtim.tv_nsec;
  if (!same) read = {now.st_ino, now.st_size, now.st_mtim, load_manifest(file)};
  return read.manifest;
}

}  // namespace

const std::string& program_hash() {
  static const std::string hash = sha256_hex_of_file(program_file());
  return hash;
}

fs::path SweepCache::finding(const std::string& key) const { return findings() / key.substr(0, 2) / key.substr(2); }

fs::path SweepCache::solution_file(const std::string& task, const std::string& method) const {
  const std::string key = sha256_hex(program_hash() + " " + task + " " + method);
  return folder_ / "solutions" / key.substr(0, 2) / (key.substr(2) + ".json");
}

std::optional<std::string> SweepCache::solution(const std::string& task, const std::string& method) const {
  return bytes_of_file(solution_file(task, method));
}

void SweepCache::keep_solution(const std::string& task, const std::string& method, const std::string& text) const {
  write_file_atomically_unsynced(solution_file(task, method), text);
}

bool SweepCache::has_pictures(const std::string& key, bool with_images) const {
  const RunFolder run = pictures(key);
  if (!is_file(run.manifest_file())) return false;
  try {
    const Manifest manifest = manifest_of(run);
    if (with_images && !manifest.not_kept.empty()) return false;
    return manifest.complete && std::all_of(manifest.files.begin(), manifest.files.end(), [&](const auto& entry) {
             return (!with_images && is_image(entry.first)) || is_file(run.root / entry.first);
           });
  } catch (const Error&) {
    return false;  // generating will say what is wrong with it
  }
}

fs::path SweepCache::mark(const std::string& key, const char* what) const {
  return folder_ / "pictures" / (key + "." + what);
}

bool SweepCache::is_observed(const std::string& key) const {
  const std::optional<std::string> text = bytes_of_file(mark(key, "observed"));
  return text && *text == program_hash();
}

void SweepCache::mark_observed(const std::string& key) const {
  write_file_atomically_unsynced(mark(key, "observed"), program_hash());
}

void SweepCache::forget_observed(const std::string& key) const {
  std::error_code ignored;
  fs::remove(mark(key, "observed"), ignored);
}

void SweepCache::mark_used(const std::string& key) const { write_file_atomically_unsynced(mark(key, "used"), ""); }

void SweepCache::shrink_to(std::uint64_t bytes, const std::set<std::string>& needed) const {
  std::vector<Deletable> renders = clean_renders_in(clean_renders());
  std::vector<Deletable> sets;
  std::error_code error;
  for (fs::directory_iterator it(folder_ / "pictures", error), end; !error && it != end; it.increment(error)) {
    const std::string key = it->path().filename().string();
    if (!it->is_directory(error)) continue;
    Deletable& set = sets.emplace_back();
    set.set = key;
    set.used = fs::last_write_time(mark(key, "used"), error);
    error.clear();
    for (const auto& file : fs::recursive_directory_iterator(it->path()))
      if (file.is_regular_file() && is_image(file.path().string())) add_file(file.path(), &set);
  }
  const auto older = [](const Deletable& a, const Deletable& b) { return a.used < b.used; };
  std::sort(renders.begin(), renders.end(), older);
  std::sort(sets.begin(), sets.end(), older);
  std::uint64_t total = 0;
  for (const auto* list : {&renders, &sets})
    for (const Deletable& entry : *list) total += entry.bytes;
  const auto remove = [&](const Deletable& entry) {
    for (const fs::path& file : entry.files) fs::remove(file, error);
    total -= entry.bytes;
  };
  for (const Deletable& render : renders)
    if (total > bytes) remove(render);
  for (const Deletable& set : sets) {
    if (total <= bytes || needed.count(set.set) > 0) continue;
    try {
      constexpr std::chrono::milliseconds kAtOnce{0};
      const FolderLock making(making_lock(set.set), "in use", FolderLock::Kind::kAlone, kAtOnce);
      const FolderLock reading(reading_lock(set.set), "in use", FolderLock::Kind::kAlone, kAtOnce);
      remove(set);
    } catch (const Error&) {
      continue;
    }
  }
}

// Depth images and clouds are told by lying beside the image of the same stem, and these lie nowhere.
Recording load_recording_of(const RunFolder& run) {
  Recording recording = load_recording(run.recording());
  const Manifest manifest = manifest_of(run);
  std::map<fs::path, std::string> files;  // by folder and stem
  for (const auto& [path, entry] : manifest.not_kept)
    files[fs::path(path).replace_extension()] = path.substr(std::string(kRecording).size());
  const auto beside = [&](const std::string& color_file, const char* folder) {
    const fs::path color(kRecording + color_file);
    const auto found = files.find(color.parent_path().parent_path() / folder / color.stem());
    return found == files.end() ? std::string() : found->second;
  };
  for (std::vector<CameraFrame>& frames : recording.frames)
    for (CameraFrame& frame : frames) {
      if (frame.depth_file.empty()) frame.depth_file = beside(frame.color_file, "depth");
      if (frame.cloud_file.empty()) frame.cloud_file = beside(frame.color_file, "cloud");
    }
  return recording;
}

CachedFindings::CachedFindings(const SweepCache& cache, const RunFolder& run) : cache_(cache) {
  const std::string prefix = kRecording;
  const Manifest manifest = manifest_of(run);
  gl_renderer_ = manifest.gl_renderer;
  for (const auto& [path, entry] : manifest.files)
    if (path.rfind(prefix, 0) == 0) contents_[path.substr(prefix.size())] = entry.sha256;
  for (const auto& [path, entry] : manifest.not_kept) {
    contents_[path.substr(prefix.size())] = entry.sha256;
    not_kept_.insert(path.substr(prefix.size()));
  }
}

void CachedFindings::opens(const std::string& file) {
  if (not_kept_.count(file) == 0) return;
  const std::lock_guard<std::mutex> guard(mutex_);
  unanswered_.insert(file);
}

std::string CachedFindings::content_of(const std::string& file) const {
  const auto found = contents_.find(file);
  return found == contents_.end() ? std::string() : found->second;
}

std::string CachedFindings::full_key(const std::string& key) { return sha256_hex(program_hash() + " " + key); }

std::optional<std::string> CachedFindings::recall(Finding finding, const std::string& key) {
  std::optional<std::string> bytes = bytes_of_file(cache_.finding(full_key(key)));
  if (bytes) ++recalled_[index(finding)];
  return bytes;
}

void CachedFindings::keep(Finding finding, const std::string& key, const std::string& bytes) {
  ++kept_[index(finding)];
  try {
    write_file_atomically_unsynced(cache_.finding(full_key(key)), bytes);
  } catch (const Error& error) {
    const std::lock_guard<std::mutex> guard(mutex_);
    failure_.emplace(error.what(), error.exit_code());
  }
}

void CachedFindings::tell(const std::function<void(const std::string& name, std::uint64_t more)>& count) {
  // In the order of Finding; depths, of which planes are made, are last and no work of their own.
  static const std::array<std::array<const char*, 2>, kFindings - 1> kNames = {
      {{"corners detected", "corners from cache"},
       {"planes fitted", "planes from cache"},
       {"clouds searched", "clouds from cache"},
       {"chessboards searched", "chessboards from cache"},
       {"board poses found", "board poses from cache"},
       {"images matched", "matches from cache"},
       {"motions found", "motions from cache"}}};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    count(kNames[i][0], kept_[i].exchange(0));
    count(kNames[i][1], recalled_[i].exchange(0));
  }
}

void CachedFindings::rethrow() const {
  if (failure_) throw MachineError(*failure_);
}

}  // namespace rigproof
