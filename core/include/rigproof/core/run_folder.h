// Where things lie in a run, and its manifest.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace rigproof {

/// runs/demo and the names inside it.
struct RunFolder {
  std::filesystem::path root;

  std::filesystem::path manifest_file() const { return root / "run.yaml"; }
  std::filesystem::path recording() const { return root / "recording"; }
  std::filesystem::path truth() const { return root / "truth"; }
  std::filesystem::path truth_file() const { return truth() / "truth.yaml"; }
  std::filesystem::path config_file() const { return truth() / "config.yaml"; }
  std::filesystem::path drive_file() const { return truth() / "drive.bin"; }
  std::filesystem::path proof_file() const { return truth() / "proof.yaml"; }
  std::filesystem::path observations_file() const { return root / "observations.json"; }
  std::filesystem::path results() const { return root / "results"; }
  std::filesystem::path result_file(const std::string& method) const { return results() / (method + ".yaml"); }
  std::filesystem::path pictures() const { return root / "pictures"; }
};

/// run.yaml: what generated the run and the size and SHA-256 of every file in recording/ and truth/.
struct Manifest {
  struct Entry {
    std::uint64_t size_bytes = 0;
    std::string sha256;
  };
  std::string tool_version;
  std::string gl_renderer;  ///< hashes of images compare only for the same one
  std::string mujoco_version;
  std::string config_sha256;  ///< of the resolved configuration: a resume must find the same
  bool complete = false;
  std::map<std::string, Entry> files;  ///< by path relative to the run
  /// Pictures that were looked at in memory: what their files would hold.
  std::map<std::string, Entry> not_kept;
};

Manifest load_manifest(const std::filesystem::path& file);
void save_manifest(const Manifest& manifest, const std::filesystem::path& file);

}  // namespace rigproof
