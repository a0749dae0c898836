// Names that completion offers for values which may be files as well.
#pragma once

#include <string>
#include <vector>

namespace rigproof {

/// Names of what a value may be: of its type on the command line ("BOARD", "[CAMERA=]SENSOR"; of what is known by its
/// place alone, its name), as the program lists them. Presets are those that are there now, the user's own
/// (RIGPROOF_PATH) among them. Empty for other types, and where the program's data are not found.
std::vector<std::string> offers_of(const std::string& type);

/// False for a type whose values are these names alone.
bool may_be_file(const std::string& type);

}  // namespace rigproof
