#pragma once

#include <string>

namespace rigproof {

/// Why a file gave no data, in words ("file is missing", "truncated PNG", "not a PNG or JPEG image", ...).
struct Unreadable {
  std::string reason;
};

}  // namespace rigproof
