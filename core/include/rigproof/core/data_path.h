// Finds what ships with the program: presets of rigs, robots, sensors, boards, scenes, and configurations.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigproof {

/// The file that this code is part of: the program's, or a Python module's. Throws Error where the system does not
/// tell.
std::filesystem::path program_file();

/// The folder that holds models/, scenes/ and config/. $RIGPROOF_DATA if it is set; for a program in its build tree
/// the source tree; else share/rigproof beside the program's bin/ or under the prefix it was configured for. Of a
/// Python module its own place counts instead of the program's. Throws Error that names every place that was tried.
std::filesystem::path data_folder();

/// Folders of the user's own, laid out as data_folder() is, whose presets come before those that ship: $RIGPROOF_PATH,
/// separated by ":". Throws Error for one that is not there.
std::vector<std::filesystem::path> user_data_folders();

/// The YAML file of a preset by its name ("d455"), or a file that the user names by a path.
/// @param kind "rigs", "robots", "sensors", "boards", "scenes" or "config".
/// An existing file wins over a preset; in config/ a name may carry folders ("budgets/ci").
/// Throws Error that names the nearest preset and all of them.
std::filesystem::path find_data_file(const std::string& kind, const std::string& name_or_path);

/// The same with the names of a folder of config/: "ci" in "budgets", where a message lists that folder's alone.
std::filesystem::path find_config_file(const std::string& folder, const std::string& name_or_path);

/// The same for presets alone: a name never reaches a file elsewhere. For names that stand in files.
std::filesystem::path find_preset(const std::string& kind, const std::string& name);

/// Names of all presets of a kind, sorted.
std::vector<std::string> list_presets(const std::string& kind);
/// Of those in a folder, by their names there: "ci" of "budgets/ci".
std::vector<std::string> list_presets(const std::string& kind, const std::string& folder);

}  // namespace rigproof
