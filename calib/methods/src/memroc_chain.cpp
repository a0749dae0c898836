#include "memroc_chain.h"

#include <Eigen/SVD>
#include <algorithm>
#include <map>
#include <memory>

#include "memroc_reference_cost.h"
#include "reference_boards.h"
#include "reference_planes.h"
#include "rigproof/calib/geometry/initial_guess.h"
#include "rival_result.h"

// What looks like a mistake of the authors' links is one of theirs, and tested as such.
namespace rigproof::rivals {
namespace {

constexpr double kLevelNormal = 0.995;

Rigid3 odometry_at(const Observations& observations, int stop) {
  const Stop& at = observations.stops[static_cast<std::size_t>(stop)];
  return planar_pose(at.x_m, at.y_m, at.yaw_rad);
}

// R_world_board that best lays the camera's path in the board frame onto the robot's path: the program leaves out that
// camera and robot move differently when the robot turns.
Eigen::Matrix3d align_paths(const Observations& observations, const BoardPoses& boards) {
  Eigen::Vector3d mean_robot = Eigen::Vector3d::Zero(), mean_camera = Eigen::Vector3d::Zero();
  for (const auto& [stop, T_camera_board] : boards) {
    mean_robot += odometry_at(observations, stop).translation;
    mean_camera += camera_position_in_board(T_camera_board);
  }
  mean_robot /= static_cast<double>(boards.size());
  mean_camera /= static_cast<double>(boards.size());
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (const auto& [stop, T_camera_board] : boards)
    H += (camera_position_in_board(T_camera_board) - mean_camera) *
         (odometry_at(observations, stop).translation - mean_robot).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d R = svd.matrixV() * svd.matrixU().transpose();
  if (R.determinant() < 0.0) {
    Eigen::Matrix3d V = svd.matrixV();
    V.col(2) *= -1.0;
    R = V * svd.matrixU().transpose();
  }
  return R;
}

// |d| of a plane whose normal is up; a ceiling's may be, too.
std::optional<double> height_of(const std::optional<CloudPlane>& plane, const Eigen::Quaterniond& R_camera_board,
                                const Eigen::Matrix3d& R_world_board) {
  if (!plane) return std::nullopt;
  const Eigen::Vector3d normal = R_world_board * (R_camera_board.conjugate() * plane->normal);
  if (normal.z() < kLevelNormal) return std::nullopt;
  return std::abs(plane->d);
}

// Both orders, so that each pair counts twice.
std::vector<ReferencePair> pairs_of(const std::vector<BoardPoses>& boards, const std::vector<int>& cameras) {
  std::vector<ReferencePair> pairs;
  for (std::size_t j = 0; j < cameras.size(); ++j) {
    for (std::size_t k = 0; k < cameras.size(); ++k) {
      const BoardPoses &of_j = boards[static_cast<std::size_t>(cameras[j])],
                       &of_k = boards[static_cast<std::size_t>(cameras[k])];
      for (const auto& [stop, from_j] : of_j) {
        const auto to_j = of_j.find(stop + 1), from_k = of_k.find(stop), to_k = of_k.find(stop + 1);
        if (j == k || to_j == of_j.end() || from_k == of_k.end() || to_k == of_k.end()) continue;
        pairs.push_back({j, k, from_j * to_j->second.inverse(), from_k->second * to_k->second.inverse()});
      }
    }
  }
  return pairs;
}

/// What our own links look at; the authors' need none of it.
struct OwnLinks {
  ViewPoses views;
  TrajectoryAlignment alignment;
  std::vector<PlaneObservation> ground;  ///< that agree with the vertical of the drive
  InitialGuess guess;
};

OwnLinks own_links(const Observations& observations) {
  OwnLinks own;
  own.views = estimate_view_poses(observations);
  own.alignment = align_trajectories(observations, own.views.poses);
  const GroundCheck check = check_ground_planes(observations, own.alignment);
  own.ground = check.planes(observations);
  own.guess = initial_guess(observations, own.views.poses, own.alignment, check);
  return own;
}

ReferenceBoards boards_of_every_view(const Observations& observations, const OwnLinks& own, bool on_plane_only) {
  ReferenceBoards boards;
  boards.poses.resize(observations.cameras.size());
  Result used;
  std::vector<Exclusion> left_out = own.views.exclusions;
  for (std::size_t i = 0; i < own.views.poses.size(); ++i) {
    const ViewPose& view = own.views.poses[i];
    if (!on_plane_only || own.alignment.view_weights[i] >= kLeastPlanarWeight)
      boards.poses[static_cast<std::size_t>(view.camera)][view.stop] = view.T_camera_board;
    else
      left_out.push_back({view.camera, view.stop, observations.board_views[static_cast<std::size_t>(view.view)].file,
                          Finding("view.off_plane")});
  }
  report_use(observations, own.views.poses, left_out, &used);
  boards.use = used.use;
  return boards;
}

/// The chain over one input. A link of the authors' and the one in its place stand beside each other.
class Chain {
 public:
  Chain(const MethodInput& input, ChainLink replaced)
      : input_(input), observations_(input.observations), replaced_(replaced) {
    if (input.recording != nullptr) frames_ = frames_by_stop(observations_, *input.recording);
    if (has(ChainLink::kPnp)) own_ = own_links(observations_);
    boards_ = find_boards();
    if (input.recording == nullptr || has(ChainLink::kPlanes))
      planes_ = std::make_unique<ObservedPlanes>(has(ChainLink::kVertical) ? own_.ground : observations_.ground_planes);
    else
      planes_ = std::make_unique<CloudPlanes>(input_, frames_);
  }

  Result solve(bool joint) {
    result_.use = boards_.use;
    problem_.geodesic = has(ChainLink::kResidual);
    for (int k = 0; k < static_cast<int>(observations_.cameras.size()); ++k) add_camera(k);
    if (joint) problem_.pairs = pairs_of(boards_.poses, solved_);
    minimise_reference(&problem_);
    for (std::size_t i = 0; i < solved_.size(); ++i)
      result_.camera_to_robot.push_back(camera_in_robot(observations_, solved_[i], problem_.X[i]));
    add_pairs_from_robot(observations_, &result_);
    conclude_by_cameras(observations_, &result_);
    return result_;
  }

 private:
  bool has(ChainLink link) const { return replaced_ >= link; }

  // Without frames no image is searched.
  ReferenceBoards find_boards() const {
    if (has(ChainLink::kPnp)) return boards_of_every_view(observations_, own_, has(ChainLink::kVertical));
    return reference_boards(input_, has(ChainLink::kCorners) ? FramesByStop() : frames_);
  }

  std::optional<Rigid3> start_of(int k) const {
    if (has(ChainLink::kStart)) return own_.guess.T_robot_camera[static_cast<std::size_t>(k)];
    const BoardPoses& seen = boards_.poses[static_cast<std::size_t>(k)];
    if (seen.empty()) return std::nullopt;
    return seen.begin()->second * odometry_at(observations_, seen.begin()->first).inverse();
  }

  std::optional<double> height_at(int stop, int k, const Rigid3& T_camera_board, const Eigen::Matrix3d& R_world_board) {
    const std::optional<CloudPlane> plane = planes_->at(stop, k);
    if (has(ChainLink::kVertical)) return plane ? std::make_optional(plane->d) : std::nullopt;
    return height_of(plane, T_camera_board.rotation, R_world_board);
  }

  void add_camera(int k) {
    const BoardPoses& seen = boards_.poses[static_cast<std::size_t>(k)];
    const std::string& name = observations_.cameras[static_cast<std::size_t>(k)].name;
    const std::optional<Rigid3> start = start_of(k);
    if (seen.empty() || !start) {
      result_.reasons.push_back(Finding("camera.no_whole_board").of(name));
      return;
    }
    const std::size_t motions = problem_.motions.size(), heights = problem_.heights.size();
    add_motions(k, seen);
    if (has(ChainLink::kResidual)) add_heights(k);
    const bool any_height = problem_.heights.size() > heights ||
                            std::any_of(problem_.motions.begin() + static_cast<std::ptrdiff_t>(motions),
                                        problem_.motions.end(), [](const auto& motion) { return motion.height_m; });
    if (problem_.motions.size() == motions)
      result_.notes.push_back(Finding("camera.at_start").of(name));
    else if (!any_height)
      result_.notes.push_back(Finding("camera.height_free").of(name));
    solved_.push_back(k);
    problem_.X.push_back(*start);
  }

  void add_motions(int k, const BoardPoses& seen) {
    const Eigen::Matrix3d R_world_board = align_paths(observations_, seen);
    for (auto to = std::next(seen.begin()); to != seen.end(); ++to) {
      const auto from = std::prev(to);
      if (to->first != from->first + 1) continue;
      ReferenceMotion motion{solved_.size(),
                             odometry_at(observations_, from->first).inverse() * odometry_at(observations_, to->first),
                             from->second * to->second.inverse(),
                             {}};
      if (!has(ChainLink::kResidual)) motion.height_m = height_at(to->first, k, to->second, R_world_board);
      problem_.motions.push_back(motion);
    }
  }

  void add_heights(int k) {
    for (const PlaneObservation& plane : own_.ground)
      if (plane.camera == k) problem_.heights.push_back({solved_.size(), height_above(plane).height_m});
  }

  const MethodInput& input_;
  const Observations& observations_;
  ChainLink replaced_;
  FramesByStop frames_;
  OwnLinks own_;
  ReferenceBoards boards_;
  std::unique_ptr<PlaneSource> planes_;
  ReferenceProblem problem_;
  std::vector<int> solved_;  // cameras, in the order of problem_.X
  Result result_;
};

}  // namespace

Result solve_chain(const MethodInput& input, bool joint, ChainLink replaced) {
  return Chain(input, replaced).solve(joint);
}

}  // namespace rigproof::rivals
