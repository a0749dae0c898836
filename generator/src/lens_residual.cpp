#include "lens_residual.h"

#include "rigproof/generator/sensor_device.h"

namespace rigproof {

double lens_residual_rms_px(const GenerateConfig& config, const RigCamera& camera) {
  // A field under intrinsics that are stated to be exact would be a lie of the rig's file.
  if (!config.render.lens_residual || camera.intrinsics_sigma == IntrinsicsSigma::exact()) return 0.0;
  return config.image_scale * load_sensor_device(camera.sensor).color.lens_residual_px;
}

std::optional<LensResidual> drawn_lens_residual(const GenerateConfig& config, const RigCamera& camera,
                                                std::int32_t index) {
  const double rms_px = lens_residual_rms_px(config, camera);
  if (!(rms_px > 0.0)) return std::nullopt;
  return draw_lens_residual(camera.camera, rms_px, load_sensor_device(camera.sensor).color.lens_residual_cells,
                            RandomStream(static_cast<std::uint64_t>(config.seed), "lens residual", -1, index));
}

}  // namespace rigproof
