// What cameras record while the robot moves: how many pictures an image has to be put together from.
#pragma once

#include <vector>

#include "rigproof/sim/exposure.h"
#include "scenario.h"

namespace rigproof {

/// When the rows of each camera are exposed, by the configuration and the sensors' presets.
std::vector<CameraShutter> resolve_shutters(const GenerateConfig& config, const Rig& rig);

/// Plans the exposures of all frames of a run that captures while moving, and labels them in the truth: exposure and
/// readout of each camera, the most parts of an image, and the largest motion within one of them. Other runs have
/// shutters that are open while the robot stands; nothing is planned.
void plan_exposures(Scenario* scenario);

/// How many pictures are drawn for a frame: one, or the parts of its exposures; depth with a camera of its own has its
/// own ones.
std::size_t pictures_of(const Scenario& scenario, const FrameJob& job);

/// Exposure of a frame's colour image and of its depth, for Renderer::render_moving().
Exposure color_exposure(const Scenario& scenario, const FrameJob& job);
Exposure depth_exposure(const Scenario& scenario, const FrameJob& job);

}  // namespace rigproof
