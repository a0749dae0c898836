#include "estimated_lenses.h"

#include <algorithm>
#include <cmath>

#include "rigproof/calib/estimate/lens_change.h"

namespace rigproof::ml {

Observations with_estimated_lenses(const Preparation& prepared, const Fit& fit, const Eigen::MatrixXd& globals) {
  Observations observations = prepared.used;
  const Layout layout = Layout::of(prepared.used, prepared.priors);
  if (!layout.has(Nuisance::kLens)) return observations;
  for (const int c : prepared.solved_cameras()) {
    RigCamera& camera = observations.cameras[static_cast<std::size_t>(c)];
    const Lenses& lenses = prepared.whitened->lenses[static_cast<std::size_t>(c)];
    const LensChange change = fit.state.nuisances.of(Nuisance::kLens, c);
    for (auto* planes : {&observations.ground_planes, &observations.board_planes})
      for (PlaneObservation& plane : *planes)
        if (plane.camera == c && follows_lens(plane, camera))
          plane.inverse_depth_plane += lenses.plane_by(plane.inverse_depth_plane) * change;
    const int focal = layout.place(Nuisance::kLens, c);
    camera.camera = lenses.changed(change);
    camera.intrinsics_sigma.focal_relative = std::sqrt(std::max(0.0, globals(focal, focal)));
  }
  return observations;
}

}  // namespace rigproof::ml
