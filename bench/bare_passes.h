// What drawing costs at least: the passes of a run's frames, drawn and read back, nothing else.
#pragma once

#include "rigproof/sim/renderer.h"
#include "scenario.h"

namespace rigproof {

/// Colour and depth as a run's configuration has them drawn.
RenderOptions render_options_of(const GenerateConfig& config);

/// Draws every frame of a run in so many processes. Throws Error where one of them fails.
void render_bare(const Scenario& scenario, int processes);

}  // namespace rigproof
