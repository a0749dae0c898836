#include "paths.h"

namespace rigproof {

std::string source_path(const std::string& relative) { return std::string(RIGPROOF_SOURCE_DIR "/") + relative; }

std::string build_path(const std::string& relative) { return std::string(RIGPROOF_BINARY_DIR "/") + relative; }

std::string program_path() { return build_path("app/rigproof"); }

}  // namespace rigproof
