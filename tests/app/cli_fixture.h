// The command as a user types it, and one small run that the tests share.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "process.h"
#include "temp_folder.h"

namespace rigproof {

/// Runs `rigproof` with the arguments.
ProcessOutput rigproof_command(const std::vector<std::string>& arguments, const std::string& folder = "");

/// Ten poses at half size, clean images, exact odometry: made by ctest's fixture, here where it is missing.
std::filesystem::path small_run();

/// A copy of the small run's recording, without truth, that a test may spoil.
std::filesystem::path copy_of_recording(const TempFolder& scratch);

/// Replaces the first occurrence of `from` in a text file; fails the test if there is none.
void edit_file(const std::filesystem::path& file, const std::string& from, const std::string& to);
std::string read_whole_file(const std::filesystem::path& file);
void write_whole_file(const std::filesystem::path& file, const std::string& text);

/// Every regular file below the folder with its content, by relative path.
std::vector<std::pair<std::string, std::string>> tree_content(const std::filesystem::path& folder);

}  // namespace rigproof
