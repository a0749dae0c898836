// What each lens does beyond its model: switched by `render.lens_residual`, as strong as the sensor's preset says.
#pragma once

#include <cstdint>
#include <optional>

#include "rigproof/core/lens_residual.h"
#include "rigproof/core/rig.h"
#include "rigproof/generator/config.h"

namespace rigproof {

/// Root mean square of a coordinate in the rendered image [px]; 0 where the run has none.
double lens_residual_rms_px(const GenerateConfig& config, const RigCamera& camera);

/// Drawn by the run's seed for the camera with this index; absent where the run has none. Throws Error if the preset
/// cannot be read.
std::optional<LensResidual> drawn_lens_residual(const GenerateConfig& config, const RigCamera& camera,
                                                std::int32_t index);

}  // namespace rigproof
