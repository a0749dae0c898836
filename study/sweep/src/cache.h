// Products of sweeps on disk, by the hash of what they depend on: pictures, detections, solutions.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "rigproof/calib/vision/picture_memory.h"
#include "rigproof/core/error.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/run_folder.h"

namespace rigproof {

/// A failure of the machine: neither the method's nor the configuration's fault, so it gives no answer.
class MachineError : public Error {
 public:
  using Error::Error;
};

/// Hash of the program that runs: what it computes may differ from what another build computes.
const std::string& program_hash();

/// Folders and files of a cache. Any number of processes may use one at once.
class SweepCache {
 public:
  explicit SweepCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path clean_renders() const { return folder_ / "renders"; }
  /// A run, as `generate` writes it.
  RunFolder pictures(const std::string& key) const { return {folder_ / "pictures" / key}; }
  /// Exclusive: held by the process that makes the pictures of a set.
  std::filesystem::path making_lock(const std::string& key) const { return folder_ / "locks" / key; }
  /// Held shared by processes that read images of a set, exclusively by the one that deletes them.
  std::filesystem::path reading_lock(const std::string& key) const { return folder_ / "locks" / (key + ".read"); }
  std::filesystem::path findings() const { return folder_ / "findings"; }
  std::filesystem::path finding(const std::string& key) const;

  /// The answer of a method to a task; absent unless this very program gave it.
  std::optional<std::string> solution(const std::string& task, const std::string& method) const;
  void keep_solution(const std::string& task, const std::string& method, const std::string& text) const;

  /// True if the run was generated to the end and, `with_images`, none of its files was deleted since.
  bool has_pictures(const std::string& key, bool with_images) const;
  /// Whether this program has looked at all of a set's pictures.
  bool is_observed(const std::string& key) const;
  void mark_observed(const std::string& key) const;
  void forget_observed(const std::string& key) const;
  /// For the order in which pictures are deleted.
  void mark_used(const std::string& key) const;

  /// Deletes clean renders, then the images of sets that were not used for the longest time, until no more than so many
  /// bytes are left. What was found in the pictures stays, and sets that a process works with.
  void shrink_to(std::uint64_t bytes, const std::set<std::string>& needed) const;

 private:
  std::filesystem::path solution_file(const std::string& task, const std::string& method) const;
  std::filesystem::path mark(const std::string& key, const char* what) const;

  std::filesystem::path folder_;
};

/// The recording of a run with the names of pictures that were not kept, too.
Recording load_recording_of(const RunFolder& run);

/// Findings in the pictures of one run, kept as small files. A file that cannot be written is reported later by
/// rethrow() as MachineError: a full disk is no property of a picture.
class CachedFindings : public PictureMemory {
 public:
  CachedFindings(const SweepCache& cache, const RunFolder& run);
  /// In pictures of these SHA-256, by file of the recording.
  CachedFindings(const SweepCache& cache, std::map<std::string, std::string> contents)
      : cache_(cache), contents_(std::move(contents)) {}

  std::string content_of(const std::string& file) const override;
  std::optional<std::string> recall(Finding finding, const std::string& key) override;
  void keep(Finding finding, const std::string& key, const std::string& bytes) override;
  void opens(const std::string& file) override;
  void rethrow() const;

  /// Pictures that were not kept, and of which something is not known that observing had to know.
  const std::set<std::string>& unanswered() const { return unanswered_; }

  /// That drew the pictures.
  const std::string& gl_renderer() const { return gl_renderer_; }
  std::uint64_t recalled(Finding finding) const { return recalled_[index(finding)]; }
  std::uint64_t kept(Finding finding) const { return kept_[index(finding)]; }
  /// Tells what was kept and recalled since the last time, as SweepCounters names it.
  void tell(const std::function<void(const std::string& name, std::uint64_t more)>& count);

 private:
  static std::size_t index(Finding finding) { return static_cast<std::size_t>(finding); }
  static std::string full_key(const std::string& key);

  const SweepCache& cache_;
  std::string gl_renderer_;
  std::map<std::string, std::string> contents_;  ///< SHA-256 by file of the recording
  std::set<std::string> not_kept_;
  std::set<std::string> unanswered_;
  std::array<std::atomic<std::uint64_t>, kFindings> recalled_ = {};
  std::array<std::atomic<std::uint64_t>, kFindings> kept_ = {};
  std::mutex mutex_;
  std::optional<MachineError> failure_;
};

}  // namespace rigproof
