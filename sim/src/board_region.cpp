#include "board_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rigproof/sim/board_pattern.h"

namespace rigproof {
namespace {

// Enough for a lens to bend an edge by less than the extra pixels below between two samples.
constexpr int kSamplesPerEdge = 16;
constexpr double kExtraPixels = 2.0;

PixelRect cut_to_image(const Camera& camera, double x_min, double x_max, double y_min, double y_max) {
  const auto clamped = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  PixelRect rect;
  rect.x0 = clamped(std::floor(x_min - kExtraPixels), camera.width_px);
  rect.y0 = clamped(std::floor(y_min - kExtraPixels), camera.height_px);
  rect.width = clamped(std::ceil(x_max + kExtraPixels) + 1.0, camera.width_px) - rect.x0;
  rect.height = clamped(std::ceil(y_max + kExtraPixels) + 1.0, camera.height_px) - rect.y0;
  return rect;
}

// Across the direction in which a length on the board, around its middle, is the shortest in the image; absent where
// the lens has no picture of it.
std::optional<double> shortest_in_image(const Camera& camera, const Rigid3& T_camera_board, const Board& board,
                                        double length_m) {
  const Eigen::Vector3d middle = board.centre();
  Eigen::Matrix2d pixels;  // of a step of that length along x and along y
  Eigen::Vector2d from, to;
  if (!camera.project(T_camera_board * middle, &from)) return std::nullopt;
  for (int axis = 0; axis < 2; ++axis) {
    if (!camera.project(T_camera_board * (middle + length_m * Eigen::Vector3d::Unit(axis)), &to)) return std::nullopt;
    pixels.col(axis) = to - from;
  }
  const double squares = pixels.squaredNorm(), twice_area = 2.0 * pixels.determinant();
  return std::sqrt(0.5 *
                   std::max(squares - std::sqrt(std::max(squares * squares - twice_area * twice_area, 0.0)), 0.0));
}

}  // namespace

PixelRect board_region(const Camera& camera, const Rigid3& T_camera_board, const Board& board, double margin_m) {
  if (T_camera_board.inverse().translation.z() >= 0.0) return {};  // the camera is behind the printed face
  std::vector<Eigen::Vector3d> outline = board.outline();
  const Eigen::Vector3d margin(margin_m, margin_m, 0.0);
  outline[0] -= margin;
  outline[1] += Eigen::Vector3d(margin_m, -margin_m, 0.0);
  outline[2] += margin;
  outline[3] += Eigen::Vector3d(-margin_m, margin_m, 0.0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double x_min = kInfinity, x_max = -kInfinity, y_min = kInfinity, y_max = -kInfinity;
  int projected = 0;
  for (std::size_t edge = 0; edge < 4; ++edge) {
    for (int i = 0; i < kSamplesPerEdge; ++i) {
      const double t = static_cast<double>(i) / kSamplesPerEdge;
      const Eigen::Vector3d p = (1.0 - t) * outline[edge] + t * outline[(edge + 1) % 4];
      Eigen::Vector2d pixel;
      if (!camera.project(T_camera_board * p, &pixel)) continue;
      ++projected;
      x_min = std::min(x_min, pixel.x());
      x_max = std::max(x_max, pixel.x());
      y_min = std::min(y_min, pixel.y());
      y_max = std::max(y_max, pixel.y());
    }
  }
  if (projected == 0) return {};
  if (projected < 4 * kSamplesPerEdge) return {0, 0, camera.width_px, camera.height_px};
  return cut_to_image(camera, x_min, x_max, y_min, y_max);
}

int board_refinement(const Camera& camera, const Rigid3& T_camera_board, const Board& board) {
  if (board.type == "checkerboard") return 2;
  constexpr double kFineEnough_px = 8.0;
  const std::optional<double> cell_px = shortest_in_image(camera, T_camera_board, board, finest_detail_m(board));
  int factor = 4;
  while (factor < 8 && cell_px && factor * *cell_px < kFineEnough_px) factor *= 2;
  return factor;
}

}  // namespace rigproof
