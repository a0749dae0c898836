// What is a bag of ROS by its name, for those who read something else.
#pragma once

#include <filesystem>

namespace rigproof {

/// A file .mcap, .db3 or .bag (also .zstd), or a folder that holds one.
bool is_named_as_bag(const std::filesystem::path& path);
/// Throws Error that says what makes a recording of it.
void refuse_bag(const std::filesystem::path& path);

}  // namespace rigproof
