// The version of the tool.
#pragma once

namespace rigproof {

/// "0.2.0", from CMake's project version.
const char* version();

}  // namespace rigproof
