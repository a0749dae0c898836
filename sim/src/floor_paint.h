// Lines and rugs that lie on the floor are seen, but have no thickness in depth.
#pragma once

#include <cstdint>

#include "gl_scene.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Thickest thing that counts as paint. GL needs some, to tell which of two surfaces is the upper one; a floor that is
/// 0.03 mm too high under a rug shows in the heights of clean runs, at six times their standard deviation.
constexpr double kThickestPaintM = 2e-4;

/// Gives what lies within kThickestPaintM of the plane z = 0 of the world that plane's depth, rounded to the counts of
/// the buffer. `depth_rows_from_bottom` holds a picture of `frustum` from `T_world_camera`, as GlScene::read_depth()
/// gives it. A camera below the floor sees no paint.
void lay_paint_on_floor(const Frustum& frustum, const Rigid3& T_world_camera, const mujoco::DepthLaw& law,
                        std::uint32_t* depth_rows_from_bottom);

}  // namespace rigproof
