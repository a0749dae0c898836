#include "rigproof/core/data_path.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "rigproof/core/error.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

bool is_data_folder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "models", ignored);
}

// The shared object that this code is part of, such as Python's module; empty in a program.
fs::path own_module() {
  Dl_info info{};
  const auto* const here = reinterpret_cast<const void*>(&data_folder);
  if (dladdr(here, &info) == 0 || info.dli_fname == nullptr || fs::path(info.dli_fname).extension() != ".so") return {};
  std::error_code error;
  const fs::path module = fs::canonical(info.dli_fname, error);
  return error ? fs::path() : module;
}

fs::path program_folder() {
  try {
    return program_file().parent_path();
  } catch (const Error&) {
    return {};
  }
}

[[maybe_unused]] bool starts_with(const fs::path& path, const fs::path& folder) {
  const auto [in_folder, in_path] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  (void)in_path;
  return in_folder == folder.end();
}

std::vector<fs::path> candidates() {
  std::vector<fs::path> folders;
  const fs::path program = program_folder();
#ifdef RIGPROOF_SOURCE_TREE
  if (starts_with(program, RIGPROOF_BUILD_TREE)) folders.emplace_back(RIGPROOF_SOURCE_TREE);
#endif
  if (!program.empty()) folders.push_back(program.parent_path() / "share" / "rigproof");
  // A module lies deeper below its prefix than a program.
  for (fs::path above = program.parent_path().parent_path(); above.has_relative_path(); above = above.parent_path())
    if (is_data_folder(above / "share" / "rigproof")) folders.push_back(above / "share" / "rigproof");
  folders.emplace_back(RIGPROOF_INSTALLED_DATA);
#ifdef RIGPROOF_SOURCE_TREE
  folders.emplace_back(RIGPROOF_SOURCE_TREE);
#endif
  return folders;
}

// Those of the user before the program's own.
std::vector<fs::path> folders_of_kind(const std::string& kind) {
  static const std::vector<std::string> kKinds = {"rigs", "robots", "sensors", "boards", "scenes", "config"};
  if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end())
    throw Error("there is no kind of preset \"" + for_message(kind) + "\"; " + suggestion(kind, kKinds));
  const bool at_top = kind == "scenes" || kind == "config";
  std::vector<fs::path> folders = user_data_folders();
  folders.push_back(data_folder());
  for (fs::path& folder : folders) folder = at_top ? folder / kind : folder / "models" / kind;
  return folders;
}

// A folder of its own may hold a preset together with its meshes: scenes/yard/scene.yaml is "yard".
std::string name_of(const fs::path& file, const fs::path& folder, const std::string& kind) {
  fs::path relative = file.lexically_relative(folder).replace_extension();
  const std::string singular = kind.substr(0, kind.size() - 1);
  if (relative.has_parent_path() && relative.filename() == singular) relative = relative.parent_path();
  return relative.generic_string();
}

struct Preset {
  std::string name;
  fs::path file;
};

std::vector<Preset> presets_of(const std::string& kind) {
  std::vector<Preset> presets;
  for (const fs::path& folder : folders_of_kind(kind)) {
    for (const fs::directory_entry& entry : folder_tree(folder))
      if (entry.path().extension() == ".yaml") presets.push_back({name_of(entry.path(), folder, kind), entry.path()});
  }
  // Of one name the first folder's.
  std::stable_sort(presets.begin(), presets.end(), [](const Preset& a, const Preset& b) { return a.name < b.name; });
  const auto same = [](const Preset& a, const Preset& b) { return a.name == b.name; };
  presets.erase(std::unique(presets.begin(), presets.end(), same), presets.end());
  return presets;
}

}  // namespace

fs::path program_file() {
  if (fs::path module = own_module(); !module.empty()) return module;
  std::error_code error;
  fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) throw Error("/proc/self/exe: " + error.message());
  return program;
}

fs::path data_folder() {
  if (const char* chosen = std::getenv("RIGPROOF_DATA"); chosen != nullptr && *chosen != '\0') {
    if (is_data_folder(chosen)) return chosen;
    throw Error("RIGPROOF_DATA: " + std::string(chosen) + ": holds no folder models/");
  }
  std::vector<std::string> tried;
  for (const fs::path& folder : candidates()) {
    if (is_data_folder(folder)) return folder;
    tried.push_back(folder.string());
  }
  throw Error("the program's data (models, scenes, config) were not found; set RIGPROOF_DATA. Tried: " + joined(tried));
}

std::vector<fs::path> user_data_folders() {
  const char* const path = std::getenv("RIGPROOF_PATH");
  const std::string all = path == nullptr ? "" : path;
  std::vector<fs::path> folders;
  for (std::size_t at = 0; at < all.size();) {
    const std::size_t end = std::min(all.find(':', at), all.size());
    std::error_code ignored;
    const fs::path folder = all.substr(at, end - at);
    if (!folder.empty() && !fs::is_directory(folder, ignored))
      throw Error("RIGPROOF_PATH: " + folder.string() + ": no such folder");
    if (!folder.empty()) folders.push_back(folder);
    at = end + 1;
  }
  return folders;
}

fs::path find_preset(const std::string& kind, const std::string& name) {
  std::vector<std::string> known;
  for (const Preset& preset : presets_of(kind)) {
    if (preset.name == name) return preset.file;
    known.push_back(preset.name);
  }
  throw Error("there is no \"" + for_message(name) + "\" among the presets of " + kind + "; " +
              suggestion(name, known));
}

fs::path find_data_file(const std::string& kind, const std::string& name_or_path) {
  std::error_code ignored;
  if (fs::is_regular_file(name_or_path, ignored)) return name_or_path;
  const fs::path path(name_or_path);
  if (path.extension() != ".yaml" && path.extension() != ".yml") return find_preset(kind, name_or_path);
  // A preset by the name of its file; whoever names another file is not told of all presets.
  const std::string name = fs::path(path).replace_extension().generic_string();
  std::vector<std::string> known;
  for (const Preset& preset : presets_of(kind)) {
    if (preset.name == name) return preset.file;
    known.push_back(preset.name);
  }
  const std::optional<std::string> nearest = nearest_name(name, known);
  throw Error(for_message(name_or_path) + ": no such file" +
              (nearest ? "; did you mean the preset \"" + *nearest + "\"?" : ""));
}

fs::path find_config_file(const std::string& folder, const std::string& name_or_path) {
  const fs::path path(name_or_path);
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored) || path.has_parent_path()) return find_data_file("config", name_or_path);
  const bool is_file_name = path.extension() == ".yaml" || path.extension() == ".yml";
  const std::string name = is_file_name ? path.stem().string() : name_or_path;
  const std::vector<std::string> known = list_presets("config", folder), all = list_presets("config");
  const auto has = [](const std::vector<std::string>& names, const std::string& wanted) {
    return std::find(names.begin(), names.end(), wanted) != names.end();
  };
  if (has(known, name)) return find_preset("config", folder + "/" + name);
  if (has(all, name)) return find_preset("config", name);
  throw Error("there is no \"" + for_message(name_or_path) + "\" among the presets of config/" + folder + "; " +
              suggestion(name, known));
}

std::vector<std::string> list_presets(const std::string& kind) {
  std::vector<std::string> names;
  for (const Preset& preset : presets_of(kind)) names.push_back(preset.name);
  return names;
}

std::vector<std::string> list_presets(const std::string& kind, const std::string& folder) {
  const std::string prefix = folder + "/";
  std::vector<std::string> names;
  for (const Preset& preset : presets_of(kind))
    if (preset.name.rfind(prefix, 0) == 0) names.push_back(preset.name.substr(prefix.size()));
  return names;
}

}  // namespace rigproof
