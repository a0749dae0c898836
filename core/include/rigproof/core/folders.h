// Folders, made and listed: one that cannot be read is an error, and never taken for an empty one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigproof {

/// Throws Error "FILE: cannot ACTION: CAUSE" for an errno. What is of the machine and not of the file (a full disk, a
/// share that is away, no descriptor left) is worth another try, and has its exit code.
[[noreturn]] void throw_system_error(const std::filesystem::path& file, const std::string& action, int error_number);

/// Makes the folder and those that it lies in; it may be there. Throws Error that names it.
void create_folder(const std::filesystem::path& folder);

/// With all that lies in it; it need not be there. Throws Error that names it.
void remove_tree(const std::filesystem::path& folder);

/// What lies in the folder, in the order of the paths; nothing where there is no such folder. Throws Error that names
/// it if it cannot be read to its end.
std::vector<std::filesystem::directory_entry> folder_entries(const std::filesystem::path& folder);
/// The same with what lies below; links to folders are not followed.
std::vector<std::filesystem::directory_entry> folder_tree(const std::filesystem::path& folder);

}  // namespace rigproof
