// JSON on standard output.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rigproof {

/// Indented. What is no UTF-8 (names of files may be any bytes) becomes U+FFFD.
std::string json_text(const nlohmann::json& json);

}  // namespace rigproof
