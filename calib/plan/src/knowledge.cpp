#include "knowledge.h"

#include <algorithm>
#include <cmath>

#include "held.h"
#include "kept_errors.h"
#include "rigproof/calib/diagnose/board_scale.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/diagnose/turning_point.h"
#include "rigproof/calib/estimate/information.h"
#include "rigproof/calib/estimate/lasting.h"
#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/unknowns.h"
#include "rigproof/calib/geometry/initial_guess.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "used_observations.h"

namespace rigproof::moved {
namespace {

constexpr double kNominalOdometryXy_m = 0.002;
constexpr double kNominalOdometryYaw_rad = 0.01;
// Odometry's systematic errors are what they are: a prior that happens to be right would count as a measurement.
constexpr double kUnknownFactor = 1e4;
constexpr double kNominalSuspensionHeight_m = 5e-4;
constexpr double kNominalSuspensionTilt_rad = 5e-4;

int camera_index(const Observations& observations, const std::string& name) {
  const auto found = std::find_if(observations.cameras.begin(), observations.cameras.end(),
                                  [&name](const RigCamera& camera) { return camera.name == name; });
  return found == observations.cameras.end() ? -1 : static_cast<int>(found - observations.cameras.begin());
}

bool known(const EstimatedTransform& transform) { return transform.fully_observable() && transform.covariance; }

// The joint covariance's rows of the matched cameras.
std::vector<Eigen::Index> rows_of(const Result& previous, const Match& match) {
  std::vector<Eigen::Index> rows;
  for (const std::string& name : match.names)
    for (std::size_t i = 0; i < previous.camera_to_robot.size(); ++i)
      for (int axis = 0; previous.camera_to_robot[i].child == name && axis < 6; ++axis)
        rows.push_back(6 * static_cast<Eigen::Index>(i) + axis);
  return rows;
}

Eigen::MatrixXd joint_of(const Result& previous, const Match& match) {
  const std::vector<Eigen::Index> rows = rows_of(previous, match);
  return Eigen::MatrixXd((*previous.joint_covariance)(rows, rows));
}

// Cameras and boards that this recording has, too, but states otherwise.
std::vector<LastingErrors::Owner> stated_otherwise(const LastingErrors& lasting, const Observations& observations) {
  const std::vector<LastingErrors::Stated> now = ml::hashes_of_stated(observations);
  std::vector<LastingErrors::Owner> otherwise;
  for (const LastingErrors::Stated& then : lasting.stated)
    for (const LastingErrors::Stated& stated : now)
      if (stated.of == then.of && stated.hash != then.hash) otherwise.push_back(then.of);
  return otherwise;
}

void note_otherwise(const std::vector<LastingErrors::Owner>& otherwise, std::vector<Finding>* notes) {
  std::vector<std::string> cameras;
  for (const LastingErrors::Owner& owner : otherwise)
    if (owner.board == 0) cameras.push_back(owner.camera);
  if (!cameras.empty()) notes->push_back(Finding("moved.camera_otherwise").of(cameras));
  if (cameras.size() < otherwise.size()) notes->emplace_back("moved.board_otherwise");
}

// Of cameras and boards of which the same is stated.
std::optional<LastingErrors> lasting_of(const Result& previous, const Observations& observations, const Match& match,
                                        std::vector<Finding>* notes) {
  if (!previous.lasting) {
    const ml::Priors stated = ml::Priors::of({observations, usual_priors(), false});
    if (!ml::lasting_unknowns(observations, stated).empty()) notes->emplace_back("moved.errors_forgotten");
    return std::nullopt;
  }
  const std::vector<LastingErrors::Owner> otherwise = stated_otherwise(*previous.lasting, observations);
  note_otherwise(otherwise, notes);
  LastingErrors lasting = *previous.lasting;
  lasting.with_cameras = Eigen::MatrixXd(lasting.with_cameras(rows_of(previous, match), Eigen::all));
  const auto is_the_same = [&](const LastingErrors::Owner& owner) {
    return std::find(otherwise.begin(), otherwise.end(), owner) == otherwise.end();
  };
  return only_of(is_the_same, std::move(lasting));
}

// What a previous result states has in it that nobody measured about which point the robot turns, the same for all
// cameras. The robot still turns about that point, wherever it is, but for what it carries.
double known_of_turning_point(const EstimatedTransform& camera, int axis) {
  constexpr double kMoves_m = 0.005;
  const double of_it =
      (*camera.covariance)(axis, axis) - variance_beside_turning_point(camera, static_cast<std::size_t>(axis));
  return std::max(0.0, of_it - kMoves_m * kMoves_m);
}

void keep_turning_point(const EstimatedTransform& camera, Eigen::MatrixXd* joint) {
  for (int axis = 0; axis < 2; ++axis)
    for (Eigen::Index i = axis; i < joint->rows(); i += 6)
      for (Eigen::Index j = axis; j < joint->cols(); j += 6) (*joint)(i, j) -= known_of_turning_point(camera, axis);
}

// Recordings that state it differently: it may be one point that was measured since, or another one under another load,
// and odometry may be that of a tracker, which turns about no point. They agree as far as each knows the origin.
void doubt_turning_point(const Result& previous, const OdometryNoise& now, KnownPoses* knowledge,
                         std::vector<Finding>* notes) {
  if (now.rotation_centre_m == previous.rotation_centre_m) return;
  notes->emplace_back("moved.turning_points_differ");
  const double usual_m = usual_priors().rotation_centre_m;
  const double variance = std::pow(previous.rotation_centre_sigma_m.value_or(usual_m), 2) +
                          std::pow(now.rotation_centre_sigma_m.value_or(usual_m), 2);
  for (Eigen::Index i = 0; i < knowledge->covariance.rows(); i += 6)
    for (Eigen::Index j = 0; j < knowledge->covariance.cols(); j += 6)
      knowledge->covariance.block<2, 2>(i, j).diagonal().array() += variance;
}

// Blocks on the diagonal, each times their number: at least as large as every covariance with these blocks.
Eigen::MatrixXd safe_joint(const std::vector<Matrix6d>& blocks) {
  const Eigen::Index n = static_cast<Eigen::Index>(blocks.size());
  Eigen::MatrixXd joint = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    joint.block<6, 6>(6 * i, 6 * i) = static_cast<double>(n) * blocks[static_cast<std::size_t>(i)];
  return joint;
}

// From the error of T_first_camera to that of T_robot_camera, the first camera's pose being exact.
Matrix6d through_first(const Rigid3& T_robot_first) {
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = T_robot_first.rotation_matrix();
  return J;
}

// Where the first camera sits on the robot, about: as good as the new observations tell in closed form.
Rigid3 about_in_robot(const Observations& observations, int camera) {
  const std::vector<ViewPose> views = estimate_view_poses(observations).poses;
  const TrajectoryAlignment alignment = align_trajectories(observations, views);
  const InitialGuess guess =
      initial_guess(observations, views, alignment, check_ground_planes(observations, alignment));
  return guess.T_robot_camera[static_cast<std::size_t>(camera)].value_or(Rigid3());
}

std::optional<KnownPoses> camera_to_camera(const Result& previous, const Observations& observations,
                                           const Match& match) {
  KnownPoses knowledge;
  const std::string& first = match.names.front();
  knowledge.T_robot_camera.push_back(about_in_robot(observations, 0));
  std::vector<Matrix6d> blocks;
  for (std::size_t i = 1; i < match.names.size(); ++i) {
    const EstimatedTransform* pair = previous.find(first, match.names[i]);
    if (pair == nullptr || !known(*pair)) return std::nullopt;
    knowledge.T_robot_camera.push_back(knowledge.T_robot_camera.front() * pair->T_parent_child);
    const Matrix6d J = through_first(knowledge.T_robot_camera.front());
    blocks.push_back(J * *pair->covariance * J.transpose());
  }
  if (blocks.empty()) return std::nullopt;
  const Eigen::MatrixXd others = safe_joint(blocks);
  knowledge.covariance = Eigen::MatrixXd::Zero(others.rows() + 6, others.cols() + 6);
  knowledge.covariance.bottomRightCorner(others.rows(), others.cols()) = others;
  knowledge.free_directions = rig_motion(knowledge.T_robot_camera);
  return knowledge;
}

// Robot poses and boards as the previous calibration sees them; the first stop is the world.
CalibrationState start_at(const std::vector<Rigid3>& T_robot_camera, const Observations& observations,
                          const std::vector<ViewPose>& views) {
  CalibrationState state;
  state.T_robot_camera = T_robot_camera;
  state.depth_scale.assign(T_robot_camera.size(), 1.0);
  state.T_world_robot = odometry_poses(observations);
  std::vector<bool> placed(observations.stops.size(), false);
  std::vector<std::optional<Rigid3>> boards(static_cast<std::size_t>(observations.boards()));
  for (const ViewPose& view : views) {
    const std::size_t stop = static_cast<std::size_t>(view.stop), c = static_cast<std::size_t>(view.camera);
    std::optional<Rigid3>& board = boards[static_cast<std::size_t>(view.board)];
    if (placed[stop] && board) continue;
    const Rigid3 T_robot_board = T_robot_camera[c] * view.T_camera_board;
    if (!board) board = state.T_world_robot[stop] * T_robot_board;
    const Rigid3 T = *board * T_robot_board.inverse();
    if (!placed[stop]) state.T_world_robot[stop] = planar_pose(T.translation.x(), T.translation.y(), yaw_of(T));
    placed[stop] = true;
  }
  state.T_world_board = boards.front().value_or(Rigid3());
  for (std::size_t b = 1; b < boards.size(); ++b) state.T_world_more_boards.push_back(boards[b].value_or(Rigid3()));
  return state;
}

// Levels that differ from the stated ones by far more than chance: a level from one view is known to a sixth, and one
// that is wrongly believed makes false alarms. 3.7 standard deviations are met by chance once in 5,000.
std::vector<double> believed_corner_scale(const Observations& observations, const std::vector<double>& estimated) {
  constexpr double kSure = 3.7;
  std::vector<double> redundancy(observations.cameras.size(), 0.0), scale(observations.cameras.size(), 1.0);
  for (const BoardView& view : observations.board_views)
    redundancy[static_cast<std::size_t>(view.camera)] +=
        std::max(0.0, 2.0 * static_cast<double>(view.corners.size()) - 6.0);
  for (std::size_t c = 0; c < scale.size(); ++c) {
    if (redundancy[c] < 4.0 || c >= estimated.size() || !(estimated[c] > 0.0)) continue;
    if (std::abs(std::log(estimated[c])) > kSure / std::sqrt(2.0 * redundancy[c])) scale[c] = estimated[c];
  }
  return scale;
}

void scale_corners(const std::vector<double>& scale, Observations* observations) {
  for (BoardView& view : observations->board_views)
    for (CornerObservation& corner : view.corners)
      corner.covariance_px2 *= std::pow(scale[static_cast<std::size_t>(view.camera)], 2);
}

CalibrationNoise believed_noise(CalibrationNoise noise, const Observations& observations, const MovedOptions& options) {
  if (!observations.odometry_noise.sigma_xy_m)
    noise.odometry_xy_m = std::max(noise.odometry_xy_m, kNominalOdometryXy_m);
  if (!observations.odometry_noise.sigma_yaw_rad)
    noise.odometry_yaw_rad = std::max(noise.odometry_yaw_rad, kNominalOdometryYaw_rad);
  noise.suspension_height_m =
      options.suspension_height_sigma_m.value_or(std::max(noise.suspension_height_m, kNominalSuspensionHeight_m));
  noise.suspension_tilt_rad =
      options.suspension_tilt_sigma_rad.value_or(std::max(noise.suspension_tilt_rad, kNominalSuspensionTilt_rad));
  noise.priors.rotation_centre_m = 0.0;  // how far it moves is in what the previous result says
  noise.priors.odometry_scale = noise.priors.odometry_yaw_factor = kUnknownFactor;
  return noise;
}

KnownPoses nothing_known(const KnownPoses& before) {
  const Eigen::Index n = before.covariance.rows();
  return {before.T_robot_camera, Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Identity(n, n), {}};
}

// The new observations, solved with all cameras free.
struct Solution {
  CalibrationState seen;             // where it started: the robot as the previous calibration sees it
  std::vector<double> corner_scale;  // by camera; 1: corners scatter as stated
  bool board_is_wrong = false;       // by the depth on it
  Observations scaled, used;         // by the corners' levels; without what was left out, or repeats in every image
  MlEstimate estimate;
};

// The images alone. Odometry that is worth nothing says what they say, so that nothing contradicts it.
Observations without_odometry(Observations observations, const CalibrationState& seen) {
  constexpr double kNoOdometry_m = 1e4, kNoOdometry_rad = 1e4;
  observations.odometry_noise.model = OdometryModel::kPerIncrement;
  observations.odometry_noise.sigma_xy_m = kNoOdometry_m;
  observations.odometry_noise.sigma_yaw_rad = kNoOdometry_rad;
  for (std::size_t i = 0; i < observations.stops.size(); ++i) {
    Stop& stop = observations.stops[i];
    stop.x_m = seen.T_world_robot[i].translation.x();
    stop.y_m = seen.T_world_robot[i].translation.y();
    stop.yaw_rad = yaw_of(seen.T_world_robot[i]);
    stop.way.clear();
  }
  return observations;
}

// By the images alone: with few stops, odometry that is wrong bends the images rather than being contradicted by them,
// and corners that are believed to scatter as far as they are bent take its part.
std::vector<double> corner_scale_without_odometry(const Observations& observations, const CalibrationState& seen,
                                                  const MlOptions& options) {
  return believed_corner_scale(observations,
                               estimate_maximum_likelihood(without_odometry(observations, seen), options).corner_scale);
}

Solution solve(const KnownPoses& before, const Observations& stated, const MovedOptions& options) {
  const Observations observations = without_places(stated);
  Solution solution;
  const std::vector<ViewPose> views = estimate_view_poses(observations).poses;
  const GroundCheck ground = check_ground_planes(observations, align_trajectories(observations, views));
  solution.seen = start_at(before.T_robot_camera, observations, views);
  solution.board_is_wrong = !ml::check_board_scale(observations, views, std::nullopt).contradictions.empty();
  MlOptions ml_options;
  ml_options.start = solution.seen;
  ml_options.suspension_height_sigma_m = options.suspension_height_sigma_m;
  ml_options.suspension_tilt_sigma_rad = options.suspension_tilt_sigma_rad;
  ml_options.estimate_plane_level = false;
  solution.corner_scale = corner_scale_without_odometry(observations, solution.seen, ml_options);
  solution.scaled = observations;
  scale_corners(solution.corner_scale, &solution.scaled);
  ml_options.estimate_corner_level = false;
  solution.estimate = estimate_maximum_likelihood(solution.scaled, ml_options);
  Observations without_repeating = solution.scaled;
  if (solution.estimate.repeating) without_repeating.board_views = solution.estimate.views_without_repeating;
  solution.used = used_observations(solution.estimate.result, without_repeating, ground);
  return solution;
}

// No place of any camera follows from it.
bool is_lost(const MlEstimate& estimate) {
  return estimate.state.T_robot_camera.empty() || has_code(estimate.result.reasons, "poses.undetermined");
}

// Odometry that is far from all that the images show also tears the poses apart until their equations have no solution.
std::vector<Finding> why_lost_or_contradicted(const MlEstimate& estimate) {
  return is_lost(estimate) && estimate.contradictions.empty() ? estimate.result.reasons : estimate.contradictions;
}

bool may_be_odometry(const MlEstimate& estimate) { return estimate.only_odometry_contradicts || is_lost(estimate); }

// The images that it has bent may be named before it: those of a camera.
Finding about_odometry(const std::vector<Finding>& contradictions) {
  const auto found = std::find_if(contradictions.begin(), contradictions.end(),
                                  [](const Finding& finding) { return finding.cameras.empty(); });
  return found == contradictions.end() ? contradictions.front() : *found;
}

// Where images and odometry are of different times, the images' places rest on the odometry's velocity.
bool any_taken_at_speed(const Observations& observations) {
  return std::any_of(observations.board_views.begin(), observations.board_views.end(), [&](const BoardView& view) {
    const Stop& stop = observations.stops[static_cast<std::size_t>(view.stop)];
    return view.stamp_s != stop.stamp_s && !stop.velocity.isZero();
  });
}

}  // namespace

Match match_cameras(const Result& previous, const Observations& observations) {
  std::vector<std::string> names;
  for (const EstimatedTransform& transform : previous.camera_to_robot) names.push_back(transform.child);
  for (const EstimatedTransform& transform : previous.camera_to_camera)
    for (const std::string& name : {transform.parent, transform.child})
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  Match match;
  bool any = false;
  for (const std::string& name : names) {
    const int index = camera_index(observations, name);
    any = any || index >= 0;
    const bool seen = std::any_of(observations.board_views.begin(), observations.board_views.end(),
                                  [index](const BoardView& view) { return view.camera == index; });
    (seen ? match.names : match.unseen).push_back(name);
    if (seen) match.observed.push_back(index);
  }
  if (!any) throw Error("moved: the previous result knows none of the observed cameras: " + joined(names));
  return match;
}

Observations of_matched(const Observations& observations, const Match& match) {
  Observations part = observations;
  part.cameras.clear();
  std::vector<int> index(observations.cameras.size(), -1);
  for (std::size_t i = 0; i < match.observed.size(); ++i) {
    const std::size_t camera = static_cast<std::size_t>(match.observed[i]);
    index[camera] = static_cast<int>(i);
    part.cameras.push_back(observations.cameras[camera]);
  }
  const auto keep = [&index](auto* items) {
    using Item = typename std::remove_reference_t<decltype(*items)>::value_type;
    const auto foreign = [&index](const Item& item) { return index[static_cast<std::size_t>(item.camera)] < 0; };
    items->erase(std::remove_if(items->begin(), items->end(), foreign), items->end());
    for (Item& item : *items) item.camera = index[static_cast<std::size_t>(item.camera)];
    std::stable_sort(items->begin(), items->end(), [](const Item& a, const Item& b) {
      return a.stop != b.stop ? a.stop < b.stop : a.camera < b.camera;
    });
  };
  keep(&part.board_views);
  keep(&part.ground_planes);
  keep(&part.board_planes);
  keep(&part.exclusions);
  return part;
}

KnownPoses previous_knowledge(const Result& previous, const Observations& observations, const Match& match,
                              std::vector<Finding>* notes) {
  KnownPoses knowledge;
  std::vector<Matrix6d> blocks;
  bool all_known = true, any_covariance = false;
  for (const std::string& name : match.names) {
    for (const EstimatedTransform& transform : previous.camera_to_robot) {
      if (transform.child != name) continue;
      any_covariance = any_covariance || transform.covariance;
      if (!known(transform)) continue;
      knowledge.T_robot_camera.push_back(transform.T_parent_child);
      Eigen::MatrixXd block = *transform.covariance;
      keep_turning_point(transform, &block);
      blocks.push_back(block);
    }
  }
  for (const EstimatedTransform& pair : previous.camera_to_camera) any_covariance = any_covariance || pair.covariance;
  all_known = blocks.size() == match.names.size();
  if (!any_covariance)
    throw Error("moved: the previous result states no uncertainty; take one of a method that does, such as ml");
  if (all_known) {
    const Eigen::Index n = 6 * static_cast<Eigen::Index>(blocks.size());
    knowledge.free_directions.resize(n, 0);
    if (previous.joint_covariance) {
      knowledge.covariance = joint_of(previous, match);
      keep_turning_point(*previous.find(previous.camera_to_robot.front().parent, match.names.front()),
                         &knowledge.covariance);
      knowledge.lasting = lasting_of(previous, observations, match, notes);
    } else {
      knowledge.covariance = safe_joint(blocks);
      if (blocks.size() > 1) notes->emplace_back("moved.errors_apart");
    }
    doubt_turning_point(previous, observations.odometry_noise, &knowledge, notes);
    return knowledge;
  }
  if (const std::optional<KnownPoses> pairs = camera_to_camera(previous, observations, match)) {
    notes->emplace_back("moved.only_pairs");
    return *pairs;
  }
  throw Error("moved: the previous result has no complete pose of every camera, neither in the robot nor in " +
              match.names.front());
}

NewKnowledge::NewKnowledge(const KnownPoses& before) : before_(before), free_(nothing_known(before)) {}

NewKnowledge::NewKnowledge(const KnownPoses& before, Observations used, const MlEstimate& estimate,
                           const CalibrationNoise& noise)
    : before_(before), used_(std::move(used)), optimum_(estimate.state), noise_(noise), repeating_(estimate.repeating) {
  const InformationBound bound = cramer_rao_bound(used_, optimum_, noise_);
  // The estimate rests on a robust loss, which keeps a little less than all of the information.
  free_ = {optimum_.T_robot_camera, bound.joint / ml::cauchy_moments(2).efficiency, bound.free_directions, {}};
}

KnownPoses NewKnowledge::if_moved(const Eigen::MatrixXd& moved) const {
  if (used_.stops.empty()) return free_;
  return held_knowledge(before_, moved, used_, optimum_, noise_, repeating_.get()).value_or(free_);
}

std::optional<NewKnowledge> NewKnowledge::with_others(
    const std::function<bool(const LastingErrors::Owner&)>& changed) const {
  if (!before_.lasting) return std::nullopt;
  NewKnowledge other = *this;
  other.before_.lasting = only_of([&](const LastingErrors::Owner& owner) { return !changed(owner); }, *before_.lasting);
  if (other.before_.lasting->unknowns.size() == before_.lasting->unknowns.size()) return std::nullopt;
  return other;
}

NewKnowledge new_knowledge(const KnownPoses& before, const Observations& observations, const MovedOptions& options,
                           std::vector<Finding>* reasons, std::vector<Finding>* notes) {
  Solution solution = solve(before, observations, options);
  const std::vector<Finding> contradictions = why_lost_or_contradicted(solution.estimate);
  const bool images_alone =
      !contradictions.empty() && may_be_odometry(solution.estimate) && !any_taken_at_speed(observations);
  if (images_alone) solution = solve(before, without_odometry(observations, solution.seen), options);
  const MlEstimate& estimate = solution.estimate;
  if (!estimate.contradictions.empty() || is_lost(estimate)) {
    *reasons = contradictions.empty() ? estimate.result.reasons : contradictions;
    const bool images =
        !estimate.contradictions.empty() && !estimate.only_odometry_contradicts && !solution.board_is_wrong;
    if (images && observations.stops.size() > 1) reasons->emplace_back("moved.while_recording");
    return NewKnowledge(before);
  }
  if (images_alone) notes->push_back(Finding("moved.odometry_ignored").by({about_odometry(contradictions)}));
  for (std::size_t c = 0; c < solution.corner_scale.size(); ++c)
    if (solution.corner_scale[c] != 1.0)
      notes->push_back(
          Finding("moved.scatter_believed", {{"times", solution.corner_scale[c]}}).of(observations.cameras[c].name));
  const CalibrationNoise noise = believed_noise(estimate.noise, solution.scaled, options);
  return {before, std::move(solution.used), estimate, noise};
}

}  // namespace rigproof::moved
