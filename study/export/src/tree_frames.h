// Names and axes of a camera's frames.
#pragma once

#include <string>
#include <vector>

#include "rigproof/study/export/export.h"

namespace rigproof {
namespace exporting {

/// Whether `link` is the optical frame itself: by its name, or because nobody named another one than the camera's own.
bool is_optical_link(const ExportCamera& camera);
/// As the user calls it, or made of the link's name.
std::string optical_frame_of(const ExportCamera& camera);

}  // namespace exporting

/// How the axes of each camera's link were read, where nobody says.
std::vector<std::string> tree_notes(const ExportJob& job);

}  // namespace rigproof
