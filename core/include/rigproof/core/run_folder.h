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

/// What generated a run, and how far it got.
struct ManifestHead {
  std::string tool_version;
  std::string gl_renderer;  ///< hashes of images compare only for the same one
  std::string mujoco_version;
  std::string config_sha256;  ///< of the resolved configuration: a resume must find the same
  bool complete = false;
};

struct FileEntry {
  std::uint64_t size_bytes = 0;
  std::string sha256;
};
using FileEntries = std::map<std::string, FileEntry>;  ///< by path relative to the run

/// run.yaml: its head, and the size and SHA-256 of every file in recording/ and truth/.
struct Manifest : ManifestHead {
  FileEntries files;
  FileEntries not_kept;  ///< pictures that were looked at in memory: what their files would hold
};

Manifest load_manifest(const std::filesystem::path& file);
void save_manifest(const Manifest& manifest, const std::filesystem::path& file);

}  // namespace rigproof
