#include "finding_bytes.h"

namespace rigproof::detection {

void write(const Camera& camera, Writer* to) {
  for (const int side : {camera.width_px, camera.height_px, static_cast<int>(camera.lens)}) to->number(side);
  for (const double value : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) to->number(value);
  for (const double value : camera.distortion) to->number(value);
}

void write(const DepthStream& depth, Writer* to) {
  const DepthNoise& noise = depth.noise;
  to->number(static_cast<int>(noise.law));
  for (const double value : {depth.unit_m, depth.min_m, depth.max_m, noise.inverse_depth_sigma_per_m, noise.constant_m,
                             noise.proportional, noise.correlation_px, noise.scale_sigma})
    to->number(value);
  if (!to->present(depth.own_camera)) return;
  write(depth.own_camera->camera, to);
  kTransformParts(*to, depth.own_camera->T_color_depth);
}

}  // namespace rigproof::detection
