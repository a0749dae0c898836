#include "floor_paint.h"

#include <cmath>

#include "depth.h"
#include "rigproof/core/vector_clones.h"

namespace rigproof {
namespace {

// The floor in a row of a picture. All in counts from the far plane, in which, as in 1/z, planes are linear.
struct FloorRow {
  double first, step;       // where the rays of the row meet the floor
  double offset;            // 1/z = slope (offset + counts)
  double paint_per_height;  // share of the camera's height that counts as paint
};

RIGPROOF_VECTOR_CLONES
void lay_row(const FloorRow& floor, int width, std::uint32_t* depth) {
  for (int x = 0; x < width; ++x) {
    const std::uint32_t packed = depth[x];
    const double seen = nearness(packed), on_floor = floor.first + x * floor.step;
    // A point on the ray is higher than the floor by the camera's height times 1 - (1/z of the floor) / (1/z seen).
    const bool both = seen >= 1.0 && on_floor >= 1.0;
    const bool paint = both && std::abs(seen - on_floor) <= floor.paint_per_height * (seen + floor.offset);
    const auto laid = packed_depth(static_cast<std::int32_t>(paint ? on_floor + 0.5 : 0.0), packed);
    depth[x] = paint ? laid : packed;
  }
}

}  // namespace

void lay_paint_on_floor(const Frustum& frustum, const Rigid3& T_world_camera, const mujoco::DepthLaw& law,
                        std::uint32_t* depth_rows_from_bottom) {
  const double height = T_world_camera.translation.z();
  if (!(height > kThickestPaintM)) return;
  const Eigen::Vector3d down = -T_world_camera.rotation_matrix().row(2).transpose();  // per ray (x, y, 1)
  const double step_x = (frustum.x_max - frustum.x_min) / frustum.width;
  const double step_y = (frustum.y_max - frustum.y_min) / frustum.height;
  FloorRow floor;
  floor.offset = law.offset_per_m / law.slope_per_m;
  floor.paint_per_height = kThickestPaintM / height;
  floor.step = down.x() * step_x / height / law.slope_per_m;
  for (int y = 0; y < frustum.height; ++y) {
    const Eigen::Vector3d ray(frustum.x_min + 0.5 * step_x, frustum.y_max - (y + 0.5) * step_y, 1.0);
    floor.first = down.dot(ray) / height / law.slope_per_m - floor.offset;
    lay_row(floor, frustum.width, depth_rows_from_bottom + static_cast<std::ptrdiff_t>(y) * frustum.width);
  }
}

}  // namespace rigproof
