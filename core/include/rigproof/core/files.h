// Files that appear whole or not at all, and reading that a hostile folder cannot abuse.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rigproof {

/// Writes to a temporary name in the same folder, fsyncs, renames, fsyncs the folder. Creates missing folders.
/// Only a regular file is replaced: a pipe or character device (/dev/null) is written to, a link is refused.
/// Throws Error that names the file and the cause (full disk, no permission); nothing half-written remains.
void write_file_atomically(const std::filesystem::path& file, std::string_view bytes);
void write_file_atomically(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes);

/// The same without either fsync: whole or not at all while the machine runs. For many files that are written quickly
/// and made to last together, with sync_files().
void write_file_atomically_unsynced(const std::filesystem::path& file, std::string_view bytes);
/// Makes files that were written unsynced, and their folders, last. Of a folder among them its name lasts, not what is
/// in it. Throws Error that names the file.
void sync_files(const std::vector<std::filesystem::path>& files);

/// Whether the name leads to a pipe or a character device (/dev/null, /dev/stdout), which takes the bytes itself.
/// Throws Error for a link and for what else is no regular file, which is never replaced.
bool takes_bytes_itself(const std::filesystem::path& file);

/// Reads a regular file of at most max_bytes. Throws Error that names the file.
std::string read_text_file(const std::filesystem::path& file, std::uintmax_t max_bytes = 64U << 20U);
std::vector<std::uint8_t> read_binary_file(const std::filesystem::path& file, std::uintmax_t max_bytes = 512U << 20U);

/// Throws Error that tells what is needed and what is free, where the folder's disk has not even a share of the bytes
/// needed. No error where the disk cannot be asked.
void require_disk_space(const std::filesystem::path& folder, double needed_bytes, double share = 1.0);

/// SHA-256 as 64 lower-case hexadecimal digits.
std::string sha256_hex(std::string_view bytes);
std::string sha256_hex_of_file(const std::filesystem::path& file);

/// folder / relative, after checking that `relative` is neither absolute nor leaves the folder, through ".." or a
/// symbolic link. Throws Error.
std::filesystem::path path_inside(const std::filesystem::path& folder, const std::string& relative);

}  // namespace rigproof
