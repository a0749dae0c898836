#include "rigproof/calib/geometry/trajectory_alignment.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "rigproof/core/conventions.h"
#include "rigproof/core/median.h"
#include "rigproof/core/rotation_between.h"

namespace rigproof {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// What a real robot adds to the noise of PnP: suspension and an uneven floor.
constexpr double kTiltFloor_rad = 3e-4;
constexpr double kHeightFloor_m = 5e-4;
// A vertical that is less certain than this is not taken from the motion.
constexpr double kMaxSigmaUp_rad = 0.02;
// Turns smaller than this in sum say nothing about the sign of the axis.
constexpr double kMinTurn_rad = 0.02;
// Normals within this angle of each other count as one plane's.
constexpr double kSamePlane_rad = 0.09;

struct Level {
  Matrix3d R_board_camera;
  Vector3d position;  // of the camera in the board frame
  Matrix3d position_covariance;
  double rotation_variance;
  int camera;
  double rotation_weight = 1.0, position_weight = 1.0;
};

std::vector<Level> make_levels(const std::vector<ViewPose>& views) {
  std::vector<Level> levels;
  for (const ViewPose& view : views) {
    const Rigid3 T_board_camera = view.T_camera_board.inverse();
    levels.push_back({T_board_camera.rotation_matrix(), T_board_camera.translation, camera_position_covariance(view),
                      view.covariance.bottomRightCorner<3, 3>().trace() / 3.0 + kTiltFloor_rad * kTiltFloor_rad,
                      view.camera});
  }
  return levels;
}

double position_variance(const Level& level, const Vector3d& up) {
  return up.dot(level.position_covariance * up) + kHeightFloor_m * kHeightFloor_m;
}

// Weighted means over the views of one camera.
struct CameraMean {
  Matrix3d rotation = Matrix3d::Zero();
  Vector3d position = Vector3d::Zero();
  double rotation_sum = 0.0, position_sum = 0.0;
};

std::vector<CameraMean> camera_means(const std::vector<Level>& levels, const Vector3d& up, std::size_t cameras) {
  std::vector<CameraMean> means(cameras);
  for (const Level& level : levels) {
    CameraMean& mean = means[static_cast<std::size_t>(level.camera)];
    const double rotation_weight = level.rotation_weight / level.rotation_variance;
    const double weight = level.position_weight / position_variance(level, up);
    mean.rotation += rotation_weight * level.R_board_camera;
    mean.rotation_sum += rotation_weight;
    mean.position += weight * level.position;
    mean.position_sum += weight;
  }
  for (CameraMean& mean : means) {
    if (mean.rotation_sum > 0.0) mean.rotation /= mean.rotation_sum;
    if (mean.position_sum > 0.0) mean.position /= mean.position_sum;
  }
  return means;
}

// Q with u^T Q u the whitened cost of "up in every camera is constant" and "every camera stays at its height".
Matrix3d planarity_matrix(const std::vector<Level>& levels, const std::vector<CameraMean>& means, const Vector3d& up) {
  Matrix3d Q = Matrix3d::Zero();
  for (const CameraMean& mean : means)
    Q += mean.rotation_sum * (Matrix3d::Identity() - mean.rotation * mean.rotation.transpose());
  for (const Level& level : levels) {
    const Vector3d offset = level.position - means[static_cast<std::size_t>(level.camera)].position;
    Q += level.position_weight / position_variance(level, up) * offset * offset.transpose();
  }
  // Only rounding makes an entry that is exactly zero in theory negative.
  return 0.5 * (Q + Q.transpose());
}

double cauchy_weight(double squared_sigmas, double softness) {
  constexpr double kCauchySigmas = 3.0;
  return 1.0 / (1.0 + squared_sigmas / (kCauchySigmas * kCauchySigmas * softness * softness));
}

// Squares in units of the variance, shrunk where most views are worse than that: a floor that rocks every view
// alike makes none of them an outlier.
void settle_scale(std::vector<double>* squared_sigmas) {
  const double scale = std::max(1.0, median(*squared_sigmas));
  for (double& value : *squared_sigmas) value /= scale;
}

void reweight(std::vector<Level>* levels, const std::vector<CameraMean>& means, const Vector3d& up, double softness) {
  std::vector<double> tilts, heights;
  for (const Level& level : *levels) {
    const CameraMean& mean = means[static_cast<std::size_t>(level.camera)];
    const Vector3d up_camera = (mean.rotation.transpose() * up).normalized();
    const double height = up.dot(level.position - mean.position);
    tilts.push_back((level.R_board_camera.transpose() * up - up_camera).squaredNorm() / level.rotation_variance);
    heights.push_back(height * height / position_variance(level, up));
  }
  settle_scale(&tilts);
  settle_scale(&heights);
  for (std::size_t i = 0; i < levels->size(); ++i) {
    (*levels)[i].rotation_weight = cauchy_weight(tilts[i], softness);
    (*levels)[i].position_weight = cauchy_weight(heights[i], softness);
  }
}

struct VerticalFit {
  Vector3d up = Vector3d::UnitZ();
  double sigma_rad = 1e9;
  Matrix3d Q = Matrix3d::Zero();
};

VerticalFit smallest_direction(const Matrix3d& Q, std::size_t views) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(Q);
  VerticalFit fit;
  fit.Q = Q;
  fit.up = eigen.eigenvectors().col(0);
  const double noise = std::max(0.0, eigen.eigenvalues()(0)), next = eigen.eigenvalues()(1);
  // The smallest eigenvalue is a chi-square with about three residuals a view; a second one of the same order is
  // noise too, and its direction equally good.
  const double scale = std::max(1.0, noise / (3.0 * static_cast<double>(views)));
  if (next > 5.0 * noise) fit.sigma_rad = std::sqrt(scale / (next - noise));
  return fit;
}

VerticalFit fit_vertical(std::vector<Level>* levels, std::size_t cameras) {
  VerticalFit fit;
  // The first rounds see even a flipped board pose as mild, so that the start cannot be captured by outliers.
  double softness = 256.0;
  for (int round = 0; round < 14; ++round) {
    std::vector<CameraMean> means = camera_means(*levels, fit.up, cameras);
    fit = smallest_direction(planarity_matrix(*levels, means, fit.up), levels->size());
    means = camera_means(*levels, fit.up, cameras);
    reweight(levels, means, fit.up, softness);
    softness = std::max(1.0, 0.5 * softness);
  }
  return fit;
}

// Positive if the cameras turn about `up` the way the odometry does.
double turning_agreement(const Observations& observations, const std::vector<ViewPose>& views,
                         const std::vector<Level>& levels, const Vector3d& up, double* turned_rad) {
  double agreement = 0.0;
  *turned_rad = 0.0;
  for (int camera = 0; camera < static_cast<int>(observations.cameras.size()); ++camera) {
    for (const ViewPair& pair : consecutive_pairs(views, camera)) {
      const Level& from = levels[static_cast<std::size_t>(pair.from - views.data())];
      const Level& to = levels[static_cast<std::size_t>(pair.to - views.data())];
      const double weight = from.rotation_weight * to.rotation_weight;
      const Eigen::Quaterniond turn(Matrix3d(to.R_board_camera * from.R_board_camera.transpose()));
      const double seen = so3_log(turn).dot(up);
      const double driven = wrap_angle(observations.stops[static_cast<std::size_t>(pair.to->stop)].yaw_rad -
                                       observations.stops[static_cast<std::size_t>(pair.from->stop)].yaw_rad);
      agreement += weight * seen * driven;
      *turned_rad = std::max(*turned_rad, std::sqrt(weight) * std::abs(seen));
    }
  }
  return agreement;
}

// Without turns the path itself tells: its bends must not be mirrored. Zero for a straight one.
double path_agreement(const Observations& observations, const std::vector<ViewPose>& views,
                      const std::vector<Level>& levels, const Vector3d& up) {
  const Matrix3d R = levelling(up);
  const std::vector<CameraMean> means = camera_means(levels, up, observations.cameras.size());
  Matrix2d cross = Matrix2d::Zero(), seen = Matrix2d::Zero(), driven = Matrix2d::Zero();
  Vector2d mean = Vector2d::Zero();
  for (const ViewPose& view : views) {
    const Stop& stop = observations.stops[static_cast<std::size_t>(view.stop)];
    mean += Vector2d(stop.x_m, stop.y_m) / static_cast<double>(views.size());
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Stop& stop = observations.stops[static_cast<std::size_t>(views[i].stop)];
    const Vector2d b = (R * (levels[i].position - means[static_cast<std::size_t>(views[i].camera)].position)).head<2>();
    const Vector2d p = Vector2d(stop.x_m, stop.y_m) - mean;
    cross += levels[i].position_weight * b * p.transpose();
    seen += b * b.transpose();
    driven += p * p.transpose();
  }
  const double scale = std::sqrt(seen.trace() * driven.trace());
  // A tenth of the length across the path is a bend that no noise makes.
  const double bend = scale > 0.0 ? cross.determinant() / (scale * scale) : 0.0;
  return std::abs(bend) > 0.0025 ? bend : 0.0;
}

// Up as a ground plane says it, in camera and in board coordinates.
struct Normal {
  int camera, stop;
  Vector3d in_camera;
  PlaneHeight height;  // of the camera over the plane
  std::optional<Vector3d> in_board;
};

std::vector<Normal> plane_normals(const Observations& observations, const std::vector<ViewPose>& views) {
  std::map<std::pair<int, int>, const ViewPose*> view_at;
  for (const ViewPose& view : views) view_at[{view.stop, view.camera}] = &view;
  std::vector<Normal> normals;
  for (const PlaneObservation& plane : observations.ground_planes) {
    const double length = plane.inverse_depth_plane.norm();
    if (!(length > 0.0)) continue;
    Normal normal{plane.camera, plane.stop, -plane.inverse_depth_plane / length, height_above(plane), std::nullopt};
    const auto view = view_at.find({plane.stop, plane.camera});
    if (view != view_at.end()) normal.in_board = view->second->T_camera_board.rotation.conjugate() * normal.in_camera;
    normals.push_back(normal);
  }
  return normals;
}

// The direction with the most others near it, then their mean; absent for an empty list.
std::optional<Vector3d> consensus(const std::vector<Vector3d>& directions) {
  const double cosine = std::cos(kSamePlane_rad);
  Vector3d best = Vector3d::Zero();
  int best_count = 0;
  for (const Vector3d& candidate : directions) {
    Vector3d sum = Vector3d::Zero();
    int count = 0;
    for (const Vector3d& other : directions) {
      if (candidate.dot(other) < cosine) continue;
      sum += other;
      ++count;
    }
    if (count > best_count) {
      best_count = count;
      best = sum;
    }
  }
  if (best_count == 0) return std::nullopt;
  return Vector3d(best.normalized());
}

// A normal along which the cameras moved is a wall's, unless they hardly moved at all. A small board far away is seen
// turned by degrees, and the camera then as far up or down: what that makes is no motion.
bool fits_motion(const std::vector<Level>& levels, const std::vector<CameraMean>& means, const Vector3d& up) {
  constexpr double kShare = 0.04, kNoise = 2.0;
  double along = 0.0, moved = 0.0, noise = 0.0;
  for (const Level& level : levels) {
    const Vector3d offset = level.position - means[static_cast<std::size_t>(level.camera)].position;
    along += std::pow(offset.dot(up), 2);
    moved += offset.squaredNorm();
    noise += up.dot(level.position_covariance * up);
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, levels.size()));
  return moved / count < 0.01 || along < kShare * moved + kNoise * noise;
}

struct Context {
  const Observations& observations;
  const std::vector<ViewPose>& views;
  std::vector<Level> levels;
  std::vector<Normal> normals;
};

// Whether the same plane, from the same height and in the same direction, was before the camera from most stops, though
// the robot moved: the ground. A wall turns away or comes nearer. Needs no pose of the board, which may be off by
// degrees.
bool stays_with_camera(const Context& context, const Normal& candidate) {
  constexpr double kMoved_m = 0.1, kTurned_rad = 0.1, kSameHeight_m = 0.02;
  const double cosine = std::cos(kSamePlane_rad);
  const auto stop_of = [&](const Normal& n) -> const Stop& {
    return context.observations.stops[static_cast<std::size_t>(n.stop)];
  };
  int all = 0, same = 0;
  bool moved = false;
  for (const Normal& other : context.normals) {
    if (other.camera != candidate.camera) continue;
    ++all;
    const double allowed = kSameHeight_m + 4.0 * std::hypot(candidate.height.sigma_m, other.height.sigma_m);
    if (candidate.in_camera.dot(other.in_camera) < cosine ||
        std::abs(candidate.height.height_m - other.height.height_m) > allowed)
      continue;
    ++same;
    const Stop &a = stop_of(candidate), &b = stop_of(other);
    moved = moved || std::hypot(b.x_m - a.x_m, b.y_m - a.y_m) > kMoved_m ||
            std::abs(wrap_angle(b.yaw_rad - a.yaw_rad)) > kTurned_rad;
  }
  return moved && same >= 3 && 2 * same > all;
}

// 1 or -1, or 0 if nothing tells.
double sign_of_up(const Context& context, const Vector3d& up) {
  double turned = 0.0;
  const double turning = turning_agreement(context.observations, context.views, context.levels, up, &turned);
  if (turned > kMinTurn_rad && turning != 0.0) return turning > 0.0 ? 1.0 : -1.0;
  double votes = 0.0;
  for (const Normal& normal : context.normals)
    if (normal.in_board && std::abs(normal.in_board->dot(up)) > std::cos(kSamePlane_rad))
      votes += normal.in_board->dot(up) > 0.0 ? 1.0 : -1.0;
  if (votes != 0.0) return votes > 0.0 ? 1.0 : -1.0;
  const double bend = path_agreement(context.observations, context.views, context.levels, up);
  return bend > 0.0 ? 1.0 : (bend < 0.0 ? -1.0 : 0.0);
}

// Up in each camera that has views, from up in the board.
void spread_to_cameras(const Context& context, TrajectoryAlignment* alignment) {
  const std::size_t cameras = context.observations.cameras.size();
  const Vector3d& up_board = alignment->up_board.front();
  const std::vector<CameraMean> means = camera_means(context.levels, up_board, cameras);
  for (std::size_t k = 0; k < cameras; ++k)
    if (means[k].rotation_sum > 0.0) alignment->up_camera[k] = (means[k].rotation.transpose() * up_board).normalized();
}

void align_by_ground(const Context& context, TrajectoryAlignment* alignment) {
  const std::size_t cameras = context.observations.cameras.size();
  const std::vector<CameraMean> means = camera_means(context.levels, Vector3d::UnitZ(), cameras);
  std::vector<Vector3d> in_board;
  for (const Normal& normal : context.normals)
    if (normal.in_board && (stays_with_camera(context, normal) || fits_motion(context.levels, means, *normal.in_board)))
      in_board.push_back(*normal.in_board);
  if (const std::optional<Vector3d> up = consensus(in_board)) {
    alignment->up_board = {*up};
    alignment->source = VerticalSource::kGround;
    alignment->sigma_up_rad = kSamePlane_rad / std::sqrt(static_cast<double>(in_board.size()));
    spread_to_cameras(context, alignment);
  }
}

std::optional<Vector3d> up_by_own_planes(const Observations& observations, std::size_t camera) {
  std::vector<Vector3d> own;
  for (const Normal& normal : plane_normals(observations, {}))
    if (normal.camera == static_cast<int>(camera)) own.push_back(normal.in_camera);
  return consensus(own);
}

// By the views of one board.
TrajectoryAlignment align_to_board(const Observations& observations, const std::vector<ViewPose>& views) {
  Context context{observations, views, make_levels(views), plane_normals(observations, views)};
  TrajectoryAlignment alignment;
  alignment.up_board = {Vector3d::UnitZ()};
  alignment.up_camera.resize(observations.cameras.size());
  const VerticalFit fit = fit_vertical(&context.levels, observations.cameras.size());
  const double sign = fit.sigma_rad < kMaxSigmaUp_rad ? sign_of_up(context, fit.up) : 0.0;
  if (sign != 0.0) {
    alignment.source = VerticalSource::kMotion;
    alignment.up_board = {sign * fit.up};
    alignment.sigma_up_rad = fit.sigma_rad;
    spread_to_cameras(context, &alignment);
  } else {
    align_by_ground(context, &alignment);
  }
  for (const Level& level : context.levels)
    alignment.view_weights.push_back(std::min(level.rotation_weight, level.position_weight));
  return alignment;
}

// A vertical, and how well it is known.
struct KnownUp {
  Vector3d up = Vector3d::UnitZ();
  double variance = std::numeric_limits<double>::infinity();

  bool is_known() const { return std::isfinite(variance); }
  bool take(const Vector3d& other, double its_variance) {
    if (!(its_variance < variance)) return false;
    *this = {other.normalized(), its_variance};
    return true;
  }
};

// From where it is known best, each time less certain by what the views between a board and a camera leave open.
// @param means of each board
void spread(const std::vector<std::vector<CameraMean>>& means, std::vector<KnownUp>* boards,
            std::vector<KnownUp>* cameras) {
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t b = 0; b < means.size(); ++b) {
      for (std::size_t k = 0; k < means[b].size(); ++k) {
        const CameraMean& mean = means[b][k];
        if (!(mean.rotation_sum > 0.0)) continue;
        KnownUp &board = (*boards)[b], &camera = (*cameras)[k];
        const double by_views = 1.0 / mean.rotation_sum;
        changed = camera.take(mean.rotation.transpose() * board.up, board.variance + by_views) || changed;
        changed = board.take(mean.rotation * camera.up, camera.variance + by_views) || changed;
      }
    }
  }
}

std::vector<CameraMean> trusted_means(const std::vector<ViewPose>& views, const TrajectoryAlignment& alignment,
                                      std::size_t cameras) {
  std::vector<Level> levels = make_levels(views);
  for (std::size_t i = 0; i < levels.size(); ++i)
    levels[i].rotation_weight = levels[i].position_weight = alignment.view_weights[i];
  return camera_means(levels, alignment.up_board.front(), cameras);
}

// Each view by how well it fits the motion past its own board.
std::vector<double> joined_weights(const std::vector<ViewPose>& views, const std::vector<TrajectoryAlignment>& own) {
  std::vector<double> weights;
  std::vector<std::size_t> next(own.size());
  for (const ViewPose& view : views) {
    const auto b = static_cast<std::size_t>(view.board);
    weights.push_back(own[b].view_weights[next[b]++]);
  }
  return weights;
}

TrajectoryAlignment align_to_boards(const Observations& observations, const std::vector<ViewPose>& views) {
  const std::size_t count = observations.cameras.size();
  std::vector<TrajectoryAlignment> own;
  std::vector<std::vector<CameraMean>> means;
  std::vector<KnownUp> boards, cameras(count);
  TrajectoryAlignment all;
  for (const std::vector<ViewPose>& of_board : by_board(views, observations.boards())) {
    own.push_back(align_to_board(observations, of_board));
    means.push_back(trusted_means(of_board, own.back(), count));
    boards.emplace_back();
    if (own.back().source != VerticalSource::kNone)
      boards.back() = {own.back().up_board.front(), own.back().sigma_up_rad * own.back().sigma_up_rad};
    if (own.back().source == VerticalSource::kMotion) all.source = VerticalSource::kMotion;
  }
  for (std::size_t k = 0; k < count; ++k)
    if (const std::optional<Vector3d> up = up_by_own_planes(observations, k))
      cameras[k] = {*up, kSamePlane_rad * kSamePlane_rad};
  spread(means, &boards, &cameras);
  double least = std::numeric_limits<double>::infinity();
  for (const KnownUp& board : boards) {
    all.up_board.push_back(board.up);
    least = std::min(least, board.variance);
  }
  for (const KnownUp& camera : cameras) {
    all.up_camera.push_back(camera.is_known() ? std::optional(camera.up) : std::nullopt);
    all.sigma_up_camera_rad.push_back(camera.is_known() ? std::sqrt(camera.variance) : 0.0);
  }
  if (all.source == VerticalSource::kNone && std::isfinite(least)) all.source = VerticalSource::kGround;
  all.sigma_up_rad = std::isfinite(least) ? std::sqrt(least) : 0.0;
  all.view_weights = joined_weights(views, own);
  return all;
}

Exclusion rejection(const PlaneObservation& plane, Finding why) {
  return {plane.camera, plane.stop, plane.file, std::move(why), true};
}

// Largest standard deviation of the plane's normal [rad].
double normal_sigma(const PlaneObservation& plane) {
  const double height = 1.0 / plane.inverse_depth_plane.norm();
  return height * std::sqrt(plane.covariance_per_m2.diagonal().maxCoeff());
}

std::optional<Finding> tilt_problem(const PlaneObservation& plane, const TrajectoryAlignment& alignment,
                                    const GroundCheckOptions& options) {
  const std::optional<Vector3d>& up = alignment.up_camera[static_cast<std::size_t>(plane.camera)];
  if (!up) return Finding("plane.vertical_unknown");
  const double length = plane.inverse_depth_plane.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return Finding("plane.degenerate");
  const double cosine = -plane.inverse_depth_plane.dot(*up) / length;
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  const std::vector<double>& of_cameras = alignment.sigma_up_camera_rad;
  const double sigma_up =
      of_cameras.empty() ? alignment.sigma_up_rad : of_cameras[static_cast<std::size_t>(plane.camera)];
  const double allowed = options.max_angle_rad + 3.0 * std::hypot(sigma_up, normal_sigma(plane));
  if (angle <= allowed) return std::nullopt;
  if (kPi - angle <= allowed) return Finding("plane.ceiling");
  return Finding("plane.off_vertical", {{"off_deg", std::lround(rad_to_deg(angle))}});
}

// The lower of the heights at which the most planes of a camera agree. Every plane would be a candidate, but for many
// some of them are as good, and the cost is that of all with all.
double common_height(const std::vector<PlaneHeight>& heights, const GroundCheckOptions& options) {
  constexpr std::size_t kMostCandidates = 500;
  const std::size_t stride = std::max<std::size_t>(1, (heights.size() + kMostCandidates - 1) / kMostCandidates);
  double best = 0.0;
  int best_count = 0;
  for (std::size_t i = 0; i < heights.size(); i += stride) {
    const PlaneHeight& candidate = heights[i];
    int count = 0;
    for (const PlaneHeight& other : heights) {
      const double allowed = options.max_height_difference_m + 4.0 * std::hypot(candidate.sigma_m, other.sigma_m);
      count += std::abs(candidate.height_m - other.height_m) <= allowed ? 1 : 0;
    }
    // A lower floor is a greater height.
    if (count > best_count || (count == best_count && candidate.height_m > best)) {
      best_count = count;
      best = candidate.height_m;
    }
  }
  return best;
}

void check_heights(const Observations& observations, int camera, const GroundCheckOptions& options,
                   GroundCheck* check) {
  std::vector<PlaneHeight> heights;
  for (std::size_t i = 0; i < observations.ground_planes.size(); ++i)
    if (check->accepted[i] && observations.ground_planes[i].camera == camera)
      heights.push_back(height_above(observations.ground_planes[i]));
  const double common = common_height(heights, options);
  for (std::size_t i = 0; i < observations.ground_planes.size(); ++i) {
    const PlaneObservation& plane = observations.ground_planes[i];
    if (!check->accepted[i] || plane.camera != camera) continue;
    const PlaneHeight height = height_above(plane);
    const double off = common - height.height_m;
    if (std::abs(off) <= 2.0 * options.max_height_difference_m + 4.0 * height.sigma_m) continue;
    check->accepted[i] = false;
    const FindingValues values = {{"off_cm", std::lround(std::abs(off) * 100.0)},
                                  {"side", off > 0.0 ? "above" : "below"}};
    check->rejected.push_back(rejection(plane, Finding("plane.other_height", values)));
  }
}

}  // namespace

Matrix3d levelling(const Vector3d& up) { return rotation_between(up, Vector3d::UnitZ()).toRotationMatrix(); }

TrajectoryAlignment align_trajectories(const Observations& observations, const std::vector<ViewPose>& views) {
  if (observations.boards() > 1) return align_to_boards(observations, views);
  TrajectoryAlignment alignment = align_to_board(observations, views);
  // A camera that never saw the board may still know the vertical from its own planes.
  for (std::size_t k = 0; k < alignment.up_camera.size(); ++k)
    if (!alignment.up_camera[k]) alignment.up_camera[k] = up_by_own_planes(observations, k);
  alignment.sigma_up_camera_rad.assign(alignment.up_camera.size(), alignment.sigma_up_rad);
  return alignment;
}

PlaneHeight height_above(const PlaneObservation& plane) {
  const Vector3d& a = plane.inverse_depth_plane;
  const double height = 1.0 / a.norm();
  // d(1/|a|) = -a^T da / |a|^3
  const double variance = a.dot(plane.covariance_per_m2 * a) * std::pow(height, 6);
  return {height, std::sqrt(std::max(0.0, variance))};
}

GroundCheck check_ground_planes(const Observations& observations, const TrajectoryAlignment& alignment,
                                const GroundCheckOptions& options) {
  GroundCheck check;
  for (const PlaneObservation& plane : observations.ground_planes) {
    const std::optional<Finding> problem = tilt_problem(plane, alignment, options);
    check.accepted.push_back(!problem);
    if (problem) check.rejected.push_back(rejection(plane, *problem));
  }
  for (int camera = 0; camera < static_cast<int>(observations.cameras.size()); ++camera)
    check_heights(observations, camera, options, &check);
  return check;
}

int GroundCheck::count(const Observations& observations, int camera) const {
  int planes = 0;
  for (std::size_t i = 0; i < accepted.size(); ++i)
    if (accepted[i] && observations.ground_planes[i].camera == camera) ++planes;
  return planes;
}

std::vector<PlaneObservation> GroundCheck::planes(const Observations& observations) const {
  std::vector<PlaneObservation> planes;
  for (std::size_t i = 0; i < accepted.size(); ++i)
    if (accepted[i]) planes.push_back(observations.ground_planes[i]);
  return planes;
}

}  // namespace rigproof
