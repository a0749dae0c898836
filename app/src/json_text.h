// JSON on standard output.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rigproof {

/// What a command prints with --json: an object says the `version` of the program, a list has no place for one. What is
/// no UTF-8 (names of files may be any bytes) becomes U+FFFD.
/// @param indent of each level; -1: on one line
std::string json_text(nlohmann::json json, int indent = 2);

}  // namespace rigproof
