#include "covering.h"

#include <cmath>

#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

// Places that one stop is chosen among, and directions for each of them and each camera.
constexpr int kPlaces = 6, kDirections = 8;
// What a camera's first view, and the first of two cameras together, are worth, in cells of an image.
constexpr double kViewWorth = 8.0, kPairWorth = 4.0;

double fresh(int times_seen) { return 1.0 / (1.0 + times_seen); }

// The robot at a place, turned so that a camera has the board's middle below or above a pixel.
std::optional<Viewpoint> turned(const Viewpoint& place, const WorldCamera& camera, const Eigen::Vector2d& pixel,
                                const Eigen::Vector3d& board_centre) {
  Eigen::Vector3d ray;
  if (!camera.camera.unproject(pixel, &ray)) return std::nullopt;
  const Eigen::Vector3d in_robot = camera.T_robot_camera.rotation * ray;
  Viewpoint stop = place;
  // The camera sits beside the robot's middle, by a little that turns with it.
  for (int round = 0; round < 3; ++round) {
    const Eigen::Vector3d to_board = board_centre - stop.T_scene_robot() * camera.T_robot_camera.translation;
    stop.yaw_rad = wrap_angle(std::atan2(to_board.y(), to_board.x()) - std::atan2(in_robot.y(), in_robot.x()));
  }
  return stop;
}

}  // namespace

SeenSoFar::SeenSoFar(const ViewpointSubject& subject)
    : subject_(subject), cameras_(subject.cameras.size()), pairs_(cameras_.size() * cameras_.size(), 0) {}

double SeenSoFar::worth(const Viewpoint& stop, const std::vector<std::size_t>& seeing) const {
  double sum = 0.0;
  for (const std::size_t a : seeing) {
    sum += kViewWorth * fresh(cameras_[a].views);
    for (const std::size_t cell : cells_of(stop, a)) sum += fresh(cameras_[a].cells[cell]);
    for (const std::size_t b : seeing)
      if (a < b) sum += kPairWorth * fresh(pairs_[a * cameras_.size() + b]);
  }
  return sum;
}

void SeenSoFar::add(const Viewpoint& stop, const std::vector<std::size_t>& seeing) {
  for (const std::size_t a : seeing) {
    ++cameras_[a].views;
    for (const std::size_t cell : cells_of(stop, a)) ++cameras_[a].cells[cell];
    for (const std::size_t b : seeing)
      if (a < b) ++pairs_[a * cameras_.size() + b];
  }
}

std::vector<std::size_t> SeenSoFar::cells_of(const Viewpoint& stop, std::size_t camera) const {
  std::vector<std::size_t> cells;
  const WorldCamera& of = subject_.cameras[camera];
  for (const Eigen::Vector2d& pixel : corners_in_image(of, stop.T_scene_robot(), subject_))
    cells.push_back(image_cell(of.camera, pixel));
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

std::optional<Viewpoint> CoveringPlanner::next(RandomStream random, Tally* tally) const {
  for (std::int64_t drawn = 0; drawn < config_.max_candidates;) {
    std::vector<Candidate> candidates;
    for (int k = 0; k < kPlaces; ++k) {
      const double distance_m = config_.distance_m.sample(random);
      const Viewpoint place = places_.place(distance_m, deg_to_rad(config_.bearing_deg.sample(random)), 0.0);
      for (const Viewpoint& stop : turned_to_board(place, &random)) {
        ++drawn;
        if (const auto worth = worth_without_obstacles(stop, tally)) candidates.push_back({stop, *worth});
      }
    }
    if (const auto stop = best_possible(std::move(candidates), tally)) return stop;
  }
  return std::nullopt;
}

// Each camera to the board, in some ways.
std::vector<Viewpoint> CoveringPlanner::turned_to_board(const Viewpoint& place, RandomStream* random) const {
  std::vector<Viewpoint> stops;
  for (const WorldCamera& camera : subject_.cameras)
    for (int k = 0; k < kDirections; ++k) {
      const double column = random->uniform() * camera.camera.width_px,
                   row = random->uniform() * camera.camera.height_px;
      if (const auto stop = turned(place, camera, {column, row}, places_.board_centre())) stops.push_back(*stop);
    }
  return stops;
}

// As far as that is told without asking the world, which takes longer.
std::optional<double> CoveringPlanner::worth_without_obstacles(const Viewpoint& stop, Tally* tally) const {
  ++tally->candidates;
  std::vector<std::size_t> facing;
  for (std::size_t i = 0; i < subject_.cameras.size(); ++i)
    if (places_.faces(i, stop)) facing.push_back(i);
  Viewpoint looked = stop;
  std::optional<Rejection> rejection;
  if (!places_.inside(stop))
    rejection = kOutside;
  else if (static_cast<int>(facing.size()) < needed())
    rejection = places_.look(needed(), &looked);
  if (!rejection) return seen_.worth(stop, facing);
  ++tally->rejected[*rejection];
  return std::nullopt;
}

std::optional<Viewpoint> CoveringPlanner::best_possible(std::vector<Candidate> candidates, Tally* tally) const {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.worth > b.worth; });
  for (Candidate& candidate : candidates) {
    const std::optional<Rejection> rejection = places_.check(needed(), &candidate.stop);
    if (!rejection) return candidate.stop;
    ++tally->rejected[*rejection];
  }
  return std::nullopt;
}

}  // namespace rigproof
