#include "bare_passes.h"

#include <memory>
#include <string>

#include "rigproof/core/error.h"
#include "worker_pool.h"

namespace rigproof {

RenderOptions render_options_of(const GenerateConfig& config) {
  RenderOptions options;
  options.psf_sigma_px = config.render.psf_sigma_px;
  options.board_at_double = config.render.board_at_double;
  options.whole_at_double = config.render.whole_at_double;
  return options;
}

void render_bare(const Scenario& scenario, int processes) {
  constexpr double kPatienceS = 600.0;
  WorkerPool pool(
      processes,
      [&](std::string*) {
        const auto renderer = std::make_shared<Renderer>(*scenario.world, render_options_of(scenario.config));
        return [&scenario, renderer](std::uint32_t frame) {
          const FrameJob& job = scenario.frames[frame];
          scenario.world->place_robot(scenario.T_scene_robot[job.stop]);
          renderer->render_bare(job.camera);
          return std::string();
        };
      },
      kPatienceS);
  std::uint32_t next = 0;
  for (std::size_t done = 0; done < scenario.frame_count();) {
    while (next < scenario.frame_count() && pool.wants_job()) pool.submit(next++);
    for (const WorkerEvent& event : pool.wait(100)) {
      if (event.kind == WorkerEvent::Kind::kDone) ++done;
      if (event.kind == WorkerEvent::Kind::kFailed || event.kind == WorkerEvent::Kind::kDied) throw Error(event.text);
    }
  }
}

}  // namespace rigproof
