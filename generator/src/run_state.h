// What is on disk of a run: is it ours, does it belong to this configuration, and what is finished.
#pragma once

#include <chrono>
#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "rigproof/core/run_folder.h"
#include "scenario.h"

namespace rigproof {

/// truth/config.yaml: the resolved configuration, and in comments the presets that it was resolved with.
std::string config_file_text(const Scenario& scenario);

/// Opens the run in `folder` for this scenario: starts it, or takes up what is there.
/// Throws Error if the folder holds something else or a run of another configuration, program or version.
/// @param fresh removes what a generation or a calibration wrote there
Manifest open_run(const RunFolder& run, const Scenario& scenario, bool fresh);

/// Forgets entries whose file is missing or has another size.
void drop_damaged(const RunFolder& run, Manifest* manifest);

/// Removes what killed writers left behind.
void remove_temporary_files(const std::filesystem::path& folder);

/// Brings the manifest to the disk now and then, beside the rendering. An entry is written only after its file has been
/// synced, so that the manifest never claims more than a power cut leaves. Of each file it holds one entry, and no
/// more.
class ManifestKeeper {
 public:
  ManifestKeeper(RunFolder run, Manifest manifest);
  ~ManifestKeeper();
  ManifestKeeper(const ManifestKeeper&) = delete;
  ManifestKeeper& operator=(const ManifestKeeper&) = delete;

  /// With all that was added, after finish().
  const Manifest& manifest() const { return manifest_; }
  const std::string& gl_renderer() const { return gl_renderer_; }
  void set_gl_renderer(const std::string& name) { gl_renderer_ = name; }
  void add(const FileEntries& entries);
  /// Of pictures that were looked at and not kept.
  void add_not_kept(const FileEntries& entries);
  /// Starts writing if there is news, the last time is long enough ago, and no write is under way.
  void tick();
  /// Writes everything; returns when it is on the disk.
  void finish(bool complete);

 private:
  /// Where no write is under way. Returns the files that are new, by their paths in the run.
  std::vector<std::string> take_up_news();

  RunFolder run_;
  Manifest manifest_;  ///< read by a write that is under way, so that nothing changes it meanwhile
  FileEntries new_files_, new_not_kept_;
  std::string gl_renderer_;
  std::future<double> write_;  ///< gives the seconds that it took
  std::chrono::steady_clock::time_point next_write_;
};

}  // namespace rigproof
