// Everything that differs between MuJoCo versions (2.2.2 in Debian, 3.x upstream), in one place.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

namespace rigproof::mujoco {

struct ModelDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using ModelPtr = std::unique_ptr<mjModel, ModelDeleter>;
using DataPtr = std::unique_ptr<mjData, DataDeleter>;

/// "2.2.2".
std::string version();

/// Turns MuJoCo's fatal errors into Error, and keeps its warnings out of the terminal and of MUJOCO_LOG.TXT.
void install_handlers();

/// Compiles MJCF text. Relative assets and includes are looked up in `folder`.
/// Returns null and MuJoCo's complaint on failure.
ModelPtr compile(const std::string& xml, const std::filesystem::path& folder, std::string* complaint);

/// The bytes of a texture, RGB, row 0 at texture coordinate v = 0; null if its layout is not three channels.
std::uint8_t* texture_bytes(mjModel* model, int texture);

/// Distance along the ray to the nearest geom of the groups that are set in `groups`, -1 if none is hit.
double cast_ray(const mjModel* model, const mjData* data, const double origin[3], const double direction[3],
                const mjtByte groups[mjNGROUP], int* geom);

/// Sets the frustum of both eyes (MuJoCo averages them) through the given bounds at the near plane.
void set_frustum(mjvScene* scene, double left, double right, double bottom, double top, double near, double far);

/// Metres along the optical axis from the 24-bit window depth: 1 / (offset + (2^24 - 1 - count) * slope).
struct DepthLaw {
  double offset_per_m;
  double slope_per_m;
};
DepthLaw depth_law(double near, double far);

}  // namespace rigproof::mujoco
