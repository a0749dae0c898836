#include "rigproof/core/run_folder.h"

#include <algorithm>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/yaml.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// Half a million files.
constexpr std::uintmax_t kMaxManifestBytes = 128U << 20U;
constexpr int kVersion = 1;
const char* const kFormat = "rigproof-run";

bool is_file(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

bool is_folder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder, ignored);
}

// What a folder holds, for a message.
std::string contents_of(const fs::path& folder) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end && names.size() < 1000; it.increment(error))
    names.push_back(for_message(it->path().filename().string()));
  if (error) return "cannot be listed (" + error.message() + ")";
  if (names.empty()) return "is empty";
  std::sort(names.begin(), names.end());
  const std::size_t count = names.size();
  names.resize(std::min(count, kMost));
  return "holds " + joined(names) + (count > kMost ? " and " + std::to_string(count - kMost) + " more" : "");
}

bool is_digest(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

Manifest::Entry read_entry(const YamlTree& tree, const std::string& path, Problems* problems) {
  MapReader map(tree, path, problems);
  map.require("size_bytes", "a whole number");
  map.require("sha256", "64 hexadecimal digits");
  Manifest::Entry entry;
  entry.size_bytes = static_cast<std::uint64_t>(map.integer("size_bytes", {0.0, 1e18}).value_or(0));
  entry.sha256 = map.text("sha256").value_or("");
  if (map.has("sha256") && !is_digest(entry.sha256)) map.problem("sha256", "must be 64 hexadecimal digits");
  map.finish();
  return entry;
}

Manifest read_manifest(const YamlTree& tree, Problems* problems) {
  Manifest manifest;
  MapReader map(tree, "", problems);
  map.require("format", kFormat);
  map.text("format", {kFormat});
  map.require("version", std::to_string(kVersion));
  map.integer("version", {static_cast<double>(kVersion), static_cast<double>(kVersion)});
  manifest.tool_version = map.text("tool_version").value_or("");
  manifest.gl_renderer = map.text("gl_renderer").value_or("");
  manifest.mujoco_version = map.text("mujoco_version").value_or("");
  manifest.config_sha256 = map.text("config_sha256").value_or("");
  map.require("state", "complete or partial");
  manifest.complete = map.text("state", {"complete", "partial"}) == "complete";
  const YamlTree* files = map.find("files");
  if (files != nullptr && !files->is_map() && !files->is_null()) map.problem("files", "must be a map of files by path");
  if (files != nullptr)
    for (const auto& [path, entry] : files->entries)
      manifest.files[path] = read_entry(entry, "files." + path, problems);
  map.finish();
  return manifest;
}

}  // namespace

InputKind classify_input(const fs::path& path) {
  if (is_file(path)) {
    if (path.extension() == ".json") return InputKind::kObservations;
    if (path.filename() == "rig.yaml" || path.filename() == "run.yaml" || path.filename() == "CalibrationInfo.yaml")
      throw Error(path.string() + ": give the folder that holds this file");
    throw Error(path.string() + ": a file is expected to be observations (.json); everything else is a folder");
  }
  if (!is_folder(path)) throw Error(path.string() + ": no such file or folder");
  if (is_file(path / "run.yaml") || is_file(path / "recording" / "rig.yaml")) return InputKind::kRun;
  if (is_file(path / "rig.yaml")) return InputKind::kRecording;
  if (is_file(path / "CalibrationInfo.yaml")) return InputKind::kMemrocLayout;
  if (is_file(path / "observations.json")) return InputKind::kObservations;
  throw Error(path.string() +
              ": not an input: run.yaml (a run), rig.yaml (a recording), CalibrationInfo.yaml (the MEMROC layout) and "
              "observations.json were looked for; the folder " +
              contents_of(path));
}

Manifest load_manifest(const fs::path& file) {
  Problems problems;
  Manifest manifest = read_manifest(read_yaml_file(file, kMaxManifestBytes), &problems);
  problems.sort();
  problems.throw_if_any();
  return manifest;
}

void save_manifest(const Manifest& manifest, const fs::path& file) {
  YamlTree tree = YamlTree::map();
  tree.set("format", YamlTree::text(kFormat));
  tree.set("version", YamlTree::integer(kVersion));
  tree.set("tool_version", YamlTree::text(manifest.tool_version));
  tree.set("gl_renderer", YamlTree::text(manifest.gl_renderer));
  tree.set("mujoco_version", YamlTree::text(manifest.mujoco_version));
  tree.set("config_sha256", YamlTree::text(manifest.config_sha256));
  tree.set("state", YamlTree::text(manifest.complete ? "complete" : "partial"));
  YamlTree& files = tree.set("files", YamlTree::map());
  for (const auto& [path, entry] : manifest.files) {
    YamlTree& line = files.set(path, YamlTree::inline_map());
    line.set("size_bytes", YamlTree::integer(static_cast<std::int64_t>(entry.size_bytes)));
    line.set("sha256", YamlTree::text(entry.sha256));
  }
  write_file_atomically(file, emit_yaml(tree));
}

}  // namespace rigproof
