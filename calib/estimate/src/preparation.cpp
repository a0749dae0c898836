#include "rigproof/calib/estimate/preparation.h"

#include <algorithm>
#include <string>
#include <utility>

#include "rigproof/core/error.h"
#include "robust_views.h"
#include "settle_repeating.h"

namespace rigproof::ml {
namespace {

CalibrationState guessed(const InitialGuess& guess) {
  CalibrationState state;
  for (const std::optional<Rigid3>& T : guess.T_robot_camera) state.T_robot_camera.push_back(T.value_or(Rigid3()));
  state.T_world_board = *guess.T_world_board;
  state.T_world_more_boards = guess.T_world_more_boards;
  state.T_world_robot = guess.T_world_robot;
  return state;
}

// Planes of the ground and of the board that solved cameras saw.
void keep_usable_planes(const GroundCheck& ground, Preparation* prepared) {
  const Observations& all = prepared->original;
  std::vector<PlaneObservation>&ground_planes = prepared->used.ground_planes,
  &board_planes = prepared->used.board_planes;
  ground_planes.clear();
  board_planes.clear();
  for (std::size_t i = 0; i < all.ground_planes.size(); ++i)
    if (ground.accepted[i] && prepared->solved(all.ground_planes[i].camera))
      ground_planes.push_back(all.ground_planes[i]);
  for (const PlaneObservation& plane : all.board_planes)
    if (prepared->solved(plane.camera)) board_planes.push_back(plane);
}

}  // namespace

Preparation closed_form(const Observations& observations, const MlOptions& options,
                        const std::vector<ViewPose>* known_views) {
  Preparation prepared(observations, options);
  for (Board& board : prepared.used.more_boards) board.place.reset();
  if (known_views != nullptr) {
    prepared.views = *known_views;
  } else {
    ViewPoses poses = estimate_view_poses(observations);
    prepared.views = std::move(poses.poses);
    prepared.excluded = std::move(poses.exclusions);
    refine_robustly(observations, &prepared.views);
  }
  prepared.alignment = align_trajectories(observations, prepared.views);
  const GroundCheck ground = check_ground_planes(observations, prepared.alignment);
  prepared.rejected_planes = ground.rejected.size();
  prepared.guess = initial_guess(observations, prepared.views, prepared.alignment, ground);
  prepared.excluded.insert(prepared.excluded.end(), ground.rejected.begin(), ground.rejected.end());
  if (!prepared.solvable()) return prepared;
  keep_usable_planes(ground, &prepared);
  if (options.start && options.start->T_world_more_boards.size() != observations.more_boards.size())
    throw Error("estimate: the start has " + std::to_string(1 + options.start->T_world_more_boards.size()) +
                " boards, the observations have " + std::to_string(observations.boards()));
  prepared.start = state_from(options.start ? *options.start : guessed(prepared.guess));
  return prepared;
}

void complete(Preparation* prepared) {
  if (!prepared->solvable()) return;
  const MlOptions& options = prepared->options;
  prepared->priors = Priors::of({prepared->used, prepared->sigmas(), options.estimate_plane_level});
  prepared->whitened = std::make_shared<const Whitened>(whitened(prepared->used));
  prepared->repeating = none_removed(prepared->used, options.priors);
  if (prepared->repeating.errors.any()) settle_repeating(prepared);
}

Preparation prepare(const Observations& observations, const MlOptions& options,
                    const std::vector<ViewPose>* known_views) {
  Preparation prepared = closed_form(observations, options, known_views);
  complete(&prepared);
  return prepared;
}

std::vector<int> Preparation::solved_cameras() const {
  std::vector<int> cameras;
  for (std::size_t c = 0; c < guess.T_robot_camera.size(); ++c)
    if (guess.T_robot_camera[c]) cameras.push_back(static_cast<int>(c));
  return cameras;
}

std::vector<int> Preparation::seen_together(const std::vector<bool>& left_out) const {
  constexpr int kEnough = 2;
  const std::size_t cameras = used.cameras.size();
  Eigen::MatrixXi stops = Eigen::MatrixXi::Zero(static_cast<Eigen::Index>(cameras), static_cast<Eigen::Index>(cameras));
  const auto counts = [&](const ViewPose& view) {
    return left_out.empty() || !left_out[static_cast<std::size_t>(view.view)];
  };
  for (std::size_t i = 0; i < views.size(); ++i)
    for (std::size_t j = i + 1; j < views.size() && views[j].stop == views[i].stop; ++j)  // sorted by stop
      if (views[i].board == views[j].board && counts(views[i]) && counts(views[j]))
        ++stops(views[i].camera, views[j].camera);
  std::vector<int> group(cameras);
  for (std::size_t c = 0; c < cameras; ++c) group[c] = static_cast<int>(c);
  for (std::size_t a = 0; a < cameras; ++a)
    for (std::size_t b = a + 1; b < cameras; ++b) {
      if (stops(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) < kEnough) continue;
      const int one = group[a], other = group[b];
      std::replace(group.begin(), group.end(), one, other);
    }
  return group;
}

std::vector<int> Preparation::tied_by_boards() const {
  std::vector<int> group(used.cameras.size()), first(static_cast<std::size_t>(used.boards()), -1);
  for (std::size_t c = 0; c < group.size(); ++c) group[c] = static_cast<int>(c);
  for (const ViewPose& view : views) {
    int& camera = first[static_cast<std::size_t>(view.board)];
    if (camera < 0) camera = view.camera;
    const int one = group[static_cast<std::size_t>(view.camera)], other = group[static_cast<std::size_t>(camera)];
    std::replace(group.begin(), group.end(), one, other);
  }
  return group;
}

PriorSigmas Preparation::sigmas() const {
  constexpr double kStanding = 0.01;  // [m/s, rad/s]: rounding of odometry is slower
  const auto moving = std::count_if(used.stops.begin(), used.stops.end(),
                                    [](const Stop& stop) { return stop.velocity.cwiseAbs().maxCoeff() > kStanding; });
  PriorSigmas sigmas = with_those_of_rig(options.priors, used.odometry_noise);
  sigmas.riding_height_m *= moving == 0 ? 0.0 : static_cast<double>(moving) / static_cast<double>(used.stops.size());
  return sigmas;
}

bool Preparation::sees(int board) const {
  return std::any_of(views.begin(), views.end(), [board](const ViewPose& view) { return view.board == board; });
}

bool Preparation::has_pose(std::size_t view) const {
  return std::any_of(views.begin(), views.end(),
                     [view](const ViewPose& pose) { return pose.view == static_cast<int>(view); });
}

}  // namespace rigproof::ml
