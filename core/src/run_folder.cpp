#include "rigproof/core/run_folder.h"

#include "rigproof/core/error.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/file_schemas.h"
#include "rigproof/core/files.h"
#include "rigproof/core/growing_file.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// Half a million files.
constexpr std::uintmax_t kMaxManifestBytes = 128U << 20U;
constexpr int kVersion = 1;
const char* const kFormat = "rigproof-run";

bool is_digest(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

static void visit_fields(FieldVisitor& visitor, FileEntry& entry) {
  visitor.on_one_line();
  visitor.require("size_bytes", "a whole number");
  visitor.require("sha256", "64 hexadecimal digits");
  auto size = static_cast<std::int64_t>(entry.size_bytes);
  visitor.field("size_bytes", size, {0.0, 1e18}, "size of the file");
  entry.size_bytes = static_cast<std::uint64_t>(size);
  visitor.field("sha256", entry.sha256, TextChoices{}, "of the file");
  visitor.check(visitor.given("sha256") == nullptr || is_digest(entry.sha256), "sha256",
                "must be 64 hexadecimal digits");
}

static void visit_fields(FieldVisitor& visitor, ManifestHead& manifest) {
  visitor.format(kFormat, kVersion);
  visitor.field("tool_version", manifest.tool_version, TextChoices{}, "of rigproof");
  visitor.field("gl_renderer", manifest.gl_renderer, TextChoices{},
                "that drew the images; hashes compare only for the same one");
  visitor.field("mujoco_version", manifest.mujoco_version, TextChoices{}, "of the physics");
  visitor.field("config_sha256", manifest.config_sha256, TextChoices{}, "of the resolved configuration");
  visitor.require("state", "complete or partial");
  visitor.choice("state", manifest.complete, {{"complete", true}, {"partial", false}},
                 "partial: generation was interrupted");
}

static void visit_fields(FieldVisitor& visitor, Manifest& manifest) {
  visit_fields(visitor, static_cast<ManifestHead&>(manifest));
  visitor.map("files", map_by_name(manifest.files), "size and hash of every file, by its path in the run");
  if (visitor.takes("not_kept", !manifest.not_kept.empty()))
    visitor.map("not_kept", map_by_name(manifest.not_kept),
                "pictures of generate --observations: size and hash of the files that they would have been");
}

Manifest load_manifest(const fs::path& file) {
  Manifest manifest;
  read_fields_of_tree(read_yaml_file(file, kMaxManifestBytes),
                      [&manifest](FieldVisitor& visitor) { visit_fields(visitor, manifest); });
  return manifest;
}

// The bytes that emit_yaml() makes of the whole tree. Written entry by entry, since the tree of hundreds of thousands
// of files takes eight times the memory of its text, again and again while the run is made.
static void append_entries(const char* key, const FileEntries& entries, GrowingFile* out) {
  out->append(std::string(key) + (entries.empty() ? ": {}\n" : ":\n"));
  for (const auto& [path, entry] : entries) {
    YamlTree line = YamlTree::map();
    line.set(path, tree_of(entry));
    out->append("  " + emit_yaml(line));
  }
}

void save_manifest(const Manifest& manifest, const fs::path& file) {
  GrowingFile out(file);
  out.append(emit_yaml(tree_of<ManifestHead>(manifest)));
  append_entries("files", manifest.files, &out);
  if (!manifest.not_kept.empty()) append_entries("not_kept", manifest.not_kept, &out);
  out.finish();
}

std::string manifest_schema() { return schema_of<Manifest>("Rigproof manifest: run.yaml of a run", {kVersion, false}); }

}  // namespace rigproof
