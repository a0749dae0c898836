// Noise of corners and planes, as stated in observations of pictures, for observations that are drawn without pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/geometric/geometric.h"

namespace rigproof {

/// The noise of each of these cameras: one sigma of corners that holds as much information as what the detector states
/// of all of them, and one of 1/z at a pixel that does the same for what the planes' covariances state. A camera of
/// which no ground (no board) plane was seen sees none. Throws Error that names the file and the cameras that are not
/// in it, have images of another size or have seen no board.
std::vector<GeometricNoise> measured_noise(const std::filesystem::path& observations,
                                           const std::vector<RigCamera>& cameras);

}  // namespace rigproof
