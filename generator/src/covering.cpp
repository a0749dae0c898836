#include "covering.h"

#include <cmath>

#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

// About so many places one stop is chosen among, and directions for each of them, each camera and each board.
constexpr std::size_t kPlaces = 6, kDirections = 8;
// What a camera's first view, and the first of two cameras together, are worth, in cells of an image.
constexpr double kViewWorth = 8.0, kPairWorth = 4.0;

bool are_pair(const Sight& a, const Sight& b) { return a.camera < b.camera && a.board == b.board; }

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

double SeenSoFar::worth(const Viewpoint& stop, const std::vector<Sight>& seeing) const {
  double sum = 0.0;
  for (const Sight& a : seeing) {
    const OfCamera& of = cameras_[a.camera];
    sum += kViewWorth * fresh(of.views);
    for (const std::size_t cell : cells_of(stop, a)) sum += fresh(of.cells[cell]);
    for (const Sight& b : seeing)
      if (are_pair(a, b)) sum += kPairWorth * fresh(pairs_[a.camera * cameras_.size() + b.camera]);
  }
  return sum;
}

void SeenSoFar::add(const Viewpoint& stop, const std::vector<Sight>& seeing) {
  for (const Sight& a : seeing) {
    ++cameras_[a.camera].views;
    for (const std::size_t cell : cells_of(stop, a)) ++cameras_[a.camera].cells[cell];
    for (const Sight& b : seeing)
      if (are_pair(a, b)) ++pairs_[a.camera * cameras_.size() + b.camera];
  }
}

std::vector<std::size_t> SeenSoFar::cells_of(const Viewpoint& stop, const Sight& sight) const {
  std::vector<std::size_t> cells;
  const WorldCamera& of = subject_.cameras[sight.camera];
  for (const Eigen::Vector2d& pixel : corners_in_image(of, stop.T_scene_robot(), subject_.board_at(sight.board)))
    cells.push_back(image_cell(of.camera, pixel));
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

std::optional<Viewpoint> CoveringPlanner::next(RandomStream random, Tally* tally) const {
  const std::size_t boards = places_.boards(), places = boards * std::max<std::size_t>(1, kPlaces / boards);
  for (std::int64_t drawn = 0; drawn < config_.max_candidates * static_cast<std::int64_t>(boards);) {
    std::vector<Candidate> candidates;
    for (std::size_t k = 0; k < places; ++k) {
      const double distance_m = config_.distance_m.sample(random);
      const double bearing_rad = deg_to_rad(config_.bearing_deg.sample(random));
      const Viewpoint place = places_.place(distance_m, bearing_rad, 0.0, k % boards);
      for (const Viewpoint& stop : turned_to_boards(place, &random)) {
        ++drawn;
        if (const auto worth = worth_without_obstacles(stop, tally)) candidates.push_back({stop, *worth});
      }
    }
    if (const auto stop = best_possible(std::move(candidates), tally)) return stop;
  }
  return std::nullopt;
}

// Each camera to each board, in some ways.
std::vector<Viewpoint> CoveringPlanner::turned_to_boards(const Viewpoint& place, RandomStream* random) const {
  std::vector<Viewpoint> stops;
  for (const WorldCamera& camera : subject_.cameras)
    for (std::size_t k = 0; k < kDirections * places_.boards(); ++k) {
      const double column = random->uniform() * camera.camera.width_px,
                   row = random->uniform() * camera.camera.height_px;
      const Eigen::Vector3d& centre = places_.board_centre(k % places_.boards());
      if (const auto stop = turned(place, camera, {column, row}, centre)) stops.push_back(*stop);
    }
  return stops;
}

// As far as that is told without asking the world, which takes longer.
std::optional<double> CoveringPlanner::worth_without_obstacles(const Viewpoint& stop, Tally* tally) const {
  ++tally->candidates;
  const std::vector<Sight> facing = places_.facing(stop);
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
