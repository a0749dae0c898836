// Where the tests find the repository's files and the built programs. Only paths.cpp knows the folders, so that the
// other objects of the tests are the same in every checkout and a compiler cache can share them.
#pragma once

#include <string>

namespace rigproof {

/// A file of the repository: source_path("config/demo.yaml").
std::string source_path(const std::string& relative = "");
/// A file of the build folder.
std::string build_path(const std::string& relative);
/// The program as built.
std::string program_path();

}  // namespace rigproof
