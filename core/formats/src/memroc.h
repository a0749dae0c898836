// What the reader and the writer of the MEMROC layout share.
#pragma once

#include "rigproof/formats/format.h"

namespace rigproof {

inline constexpr const char* kMemrocInfoFile = "CalibrationInfo.yaml";
inline constexpr const char* kMemrocIntrinsicsFile = "intrinsic_pars_file.yaml";

/// A stop is a frame number; of several images of a camera at one stop the middle one is taken. Depth images become
/// clouds in the colour camera's frame. Throws Error with every problem for what the layout cannot say (a fisheye
/// lens, a board that is ambiguous under half a turn).
ConvertReport write_memroc(const WriteJob& job);

}  // namespace rigproof
