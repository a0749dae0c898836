// How a depth image is measured: noise, errors, rounding and range, row by row.
#pragma once

#include "rigproof/core/image.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {

/// Writes the recorded counts of a whole image. The effects of the model are prepared.
/// @param depth_m what the measurement sees
void measure_depth(const ImageF& depth_m, const DepthSensing& model, double depth_scale, const FrameSeed& frame,
                   Image16* counts);

/// The clean depth, scaled and rounded to the unit.
void round_depth(const ImageF& depth_m, double unit_m, double depth_scale, Image16* counts);

}  // namespace rigproof
