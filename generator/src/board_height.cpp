#include "board_height.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigproof/generator/coverage.h"

namespace rigproof {
namespace {

constexpr double kStep_m = 0.05, kHighest_m = 1.5, kClearance_m = 0.05;
// Of an image's width: what cuts the board off at one size of the image does so at another.
constexpr double kMargin = 0.01;
constexpr double kNearest_m = 1.2, kFarthest_m = 3.6;

class FreeFloor : public ViewpointWorld {
 public:
  FloorArea drivable_area() override {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    return {-kFar, kFar, -kFar, kFar};
  }
  std::string obstacle(const Rigid3&) override { return {}; }
  bool in_sight(const Eigen::Vector3d&, const Eigen::Vector3d&, std::size_t) override { return true; }
};

ViewpointConfig reference_places(const std::vector<WorldCamera>& cameras) {
  ViewpointConfig config;
  config.distance_m = Distribution::Kind(Distribution::Uniform{kNearest_m, kFarthest_m});
  config.bearing_deg = 0.0;
  double width_px = 0.0;
  for (const WorldCamera& camera : cameras) width_px = std::max<double>(width_px, camera.camera.width_px);
  config.margin_px = kMargin * width_px;
  return config;
}

double lowest_point(const Rigid3& T_world_board, const Board& board, double margin_m) {
  const Eigen::Vector3d along_x = T_world_board.rotation * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d along_y = T_world_board.rotation * Eigen::Vector3d::UnitY();
  const Eigen::Vector3d half = board.centre() - board.outline()[0];
  return (T_world_board * board.centre()).z() - std::abs(along_x.z()) * (std::abs(half.x()) + margin_m) -
         std::abs(along_y.z()) * (std::abs(half.y()) + margin_m);
}

// Doubling what one camera sees is worth the same, however little that was; one that sees nothing weighs most.
double worth(const std::vector<CameraCoverage>& possible) {
  double sum = 0.0;
  for (const CameraCoverage& camera : possible) sum += std::log(0.1 + static_cast<double>(camera.cells));
  return sum;
}

}  // namespace

BoardPlacement at_fitting_height(const BoardPlacement& placement, const std::vector<WorldCamera>& cameras,
                                 const Board& board, double margin_m) {
  const ViewpointConfig config = reference_places(cameras);
  FreeFloor floor;
  BoardPlacement best = placement, tried = placement;
  // Places of the robot are told from the board: where it stands and which way it faces is the same to them.
  tried.x_m = tried.y_m = tried.facing_deg = 0.0;
  double most = -std::numeric_limits<double>::infinity();
  for (int step = 1; step * kStep_m <= kHighest_m; ++step) {
    tried.z_m = step * kStep_m;
    const ViewpointSubject subject{{board, place_board(board, tried), margin_m}, cameras};
    if (lowest_point(subject.T_scene_board, board, margin_m) < kClearance_m) continue;
    const double here = worth(possible_coverage(config, subject, floor));
    if (here <= most) continue;
    most = here;
    best.z_m = tried.z_m;
  }
  return best;
}

}  // namespace rigproof
