#include "rigproof/core/board.h"

namespace rigproof {

std::vector<Eigen::Vector3d> Board::corners() const {
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(corner_count()));
  for (int id = 0; id < corner_count(); ++id) points.push_back(corner(id));
  return points;
}

std::vector<Eigen::Vector3d> Board::outline() const {
  const double left = along(-1), right = along(inner_corners_x());
  const double top = along(-1), bottom = along(inner_corners_y());
  return {{left, top, 0.0}, {right, top, 0.0}, {right, bottom, 0.0}, {left, bottom, 0.0}};
}

Eigen::Vector3d Board::centre() const {
  return {0.5 * along(inner_corners_x() - 1), 0.5 * along(inner_corners_y() - 1), 0.0};
}

}  // namespace rigproof
