#include "swapped_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "rigproof/calib/estimate/residuals.h"
#include "rigproof/calib/estimate/solver.h"
#include "rigproof/calib/geometry/pnp.h"
#include "stop_edits.h"

namespace rigproof::ml {
namespace {

// A pose by PnP is sure to centimetres and a degree or two; cameras that are mounted nearer to each other than that
// cannot be told apart by single frames.
constexpr double kAgrees_m = 0.15, kAgrees_rad = 0.08;
constexpr double kDiffers = 2.0;  // times that
// More stops than these, and than one in five, are no exceptions: their frames are not looked at one by one.
constexpr std::size_t kFew = 8, kMany = 5;
// Stops before and after one whose frames are exchanged: what is farther does not feel it.
constexpr int kNear = 12;

// From the nearest stop that nothing is wrong with, by odometry.
std::optional<Rigid3> predicted_pose(const Observations& observations, const State& state,
                                     const std::vector<bool>& doubtful, std::size_t stop) {
  for (std::size_t distance = 1; distance < doubtful.size(); ++distance) {
    for (const bool back : {true, false}) {
      if (back ? distance > stop : stop + distance >= doubtful.size()) continue;
      const std::size_t from = back ? stop - distance : stop + distance;
      if (doubtful[from]) continue;
      const Eigen::Vector3d moved = measured_increment(observations.stops[from], observations.stops[stop]);
      const Rigid3 motion = planar_pose(moved.x() / state.odometry_scale(), moved.y() / state.odometry_scale(),
                                        moved.z() / state.odometry_yaw_factor());
      return state.poses[from].transform() * motion;
    }
  }
  return std::nullopt;
}

// Of the robot, by a board that a camera sees.
Rigid3 pose_by(const State& state, const Rigid3& T_camera_board, int camera, int board) {
  return state.first_pose(Step::board(board)) * (state.first_pose(camera) * T_camera_board).inverse();
}

// 1 = at the limit of agreement.
double disagreement(const Rigid3& seen, const Rigid3& T_world_robot) {
  const Vector6d error = transform_error(seen, T_world_robot);
  return std::max(error.head<3>().norm() / kAgrees_m, error.tail<3>().norm() / kAgrees_rad);
}

// The camera whose frame this really is; -1 if it is nobody's.
int best_camera(const Observations& observations, const State& state, const ViewPose& view, const Rigid3& predicted) {
  int best = -1;
  double least = 1.0;
  for (int c = 0; c < static_cast<int>(observations.cameras.size()); ++c) {
    if (c == view.camera) continue;
    const std::optional<BoardPose> pose = estimate_board_pose(
        observations.board_views[static_cast<std::size_t>(view.view)].corners, observations.board_at(view.board),
        observations.cameras[static_cast<std::size_t>(c)].camera);
    if (!pose) continue;
    const double off = disagreement(pose_by(state, pose->T_camera_board, c, view.board), predicted);
    if (off >= least) continue;
    least = off;
    best = c;
  }
  return best;
}

// The robot's pose at a stop as each view there proposes it.
std::vector<RobotPose> proposals(const Observations& observations, const State& state, int stop) {
  std::vector<RobotPose> poses;
  for (const BoardView& view : observations.board_views) {
    if (view.stop != stop) continue;
    const Camera& camera = observations.cameras[static_cast<std::size_t>(view.camera)].camera;
    if (const auto pose = estimate_board_pose(view.corners, observations.board_of(view), camera))
      poses.push_back(RobotPose::from_transform(pose_by(state, pose->T_camera_board, view.camera, view.board)));
  }
  return poses;
}

// A solved run about one of its stops: all of it if it is short, else the stops near it, with the cameras as they were
// solved.
class Near {
 public:
  Near(const Problem& solved, const State& solution, int stop) : solved_(solved), state_(solution) {
    const int stops = static_cast<int>(solved.observations().stops.size());
    const bool all = stops <= 4 * kNear;
    first_ = all ? 0 : std::max(0, stop - kNear);
    const int end = all ? stops : std::min(stops, stop + kNear + 1);
    stop_ = stop - first_;
    observations_ = stops_between(solved.observations(), first_, end);
    state_.poses = {solution.poses.begin() + first_, solution.poses.begin() + end};
    camera_fixed_ = all ? solved.camera_fixed : std::vector<bool>(solved.camera_fixed.size(), true);
    const std::vector<BoardView>& filed = solved.observations().board_views;
    for (std::size_t v = 0; v < filed.size(); ++v)
      if (solved.view_left_out[v]) left_out_.insert({filed[v].stop - first_, filed[v].camera});
  }

  const Observations& observations() const { return observations_; }
  int stop() const { return stop_; }

  /// Least cost when every view of the stop counts, filed as in `observations`.
  double cost_with_all_views(const Observations& observations) const {
    Problem problem(observations, solved_.priors(), solved_.noise);
    problem.camera_fixed = camera_fixed_;
    for (std::size_t v = 0; v < observations.board_views.size(); ++v) {
      const BoardView& view = observations.board_views[v];
      problem.view_left_out[v] = view.stop != stop_ && left_out_.count({view.stop, view.camera}) > 0;
    }
    State state = state_;
    RobotPose& pose = state.poses[static_cast<std::size_t>(stop_)];
    RobotPose best = pose;
    double least = 0.0;
    problem.linearise(state, Weighting::kRobust, &least, nullptr);
    for (const RobotPose& proposed : proposals(observations, state_, stop_)) {
      double cost = 0.0;
      pose = proposed;
      problem.linearise(state, Weighting::kRobust, &cost, nullptr);
      if (cost >= least) continue;
      least = cost;
      best = proposed;
    }
    pose = best;
    SolverOptions options;
    options.max_iterations = 8;
    options.tolerance = 0.1;
    return minimise(problem, options, &state).cost;
  }

 private:
  const Problem& solved_;
  State state_;
  int first_ = 0, stop_ = 0;
  Observations observations_;
  std::vector<bool> camera_fixed_;
  std::set<std::pair<int, int>> left_out_;  // stop, camera
};

}  // namespace

std::vector<SwappedFrames> find_swapped_frames(const Observations& observations, const std::vector<ViewPose>& views,
                                               const State& state, const std::vector<bool>& doubtful) {
  if (state.poses.size() != doubtful.size()) return {};
  std::map<std::pair<int, int>, std::vector<int>> found;  // stops by the two cameras
  for (const ViewPose& view : views) {
    const std::size_t stop = static_cast<std::size_t>(view.stop);
    if (!doubtful[stop]) continue;
    const std::optional<Rigid3> predicted = predicted_pose(observations, state, doubtful, stop);
    if (!predicted || disagreement(pose_by(state, view.T_camera_board, view.camera, view.board), *predicted) < kDiffers)
      continue;
    const int other = best_camera(observations, state, view, *predicted);
    if (other < 0) continue;
    std::vector<int>& stops = found[std::minmax(view.camera, other)];
    if (stops.empty() || stops.back() != view.stop) stops.push_back(view.stop);
  }
  std::vector<SwappedFrames> result;
  for (auto& [pair, stops] : found) result.push_back({pair.first, pair.second, std::move(stops)});
  return result;
}

std::vector<SwappedFrames> likelier_swapped(const Problem& problem, const State& state,
                                            const std::vector<SwappedFrames>& candidates) {
  constexpr double kDecides = 20.0;  // -2 ln of the likelihood ratio
  std::vector<SwappedFrames> kept;
  for (const SwappedFrames& candidate : candidates) {
    if (candidate.stops.size() > std::max(kFew, problem.observations().stops.size() / kMany)) continue;
    SwappedFrames likelier{candidate.first, candidate.second, {}};
    for (const int stop : candidate.stops) {
      const Near near(problem, state, stop);
      Observations exchanged = near.observations();
      swap_frames(near.stop(), candidate.first, candidate.second, &exchanged);
      const double as_filed = near.cost_with_all_views(near.observations());
      if (near.cost_with_all_views(exchanged) < as_filed - kDecides) likelier.stops.push_back(stop);
    }
    if (!likelier.stops.empty()) kept.push_back(std::move(likelier));
  }
  return kept;
}

Finding finding_of(const SwappedFrames& swapped, const Observations& observations) {
  return Finding("frames.swapped")
      .of({observations.cameras[static_cast<std::size_t>(swapped.first)].name,
           observations.cameras[static_cast<std::size_t>(swapped.second)].name})
      .at(swapped.stops);
}

}  // namespace rigproof::ml
