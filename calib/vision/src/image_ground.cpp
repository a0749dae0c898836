#include "rigproof/calib/vision/image_ground.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_pairs.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

using rivals::ImagePair;
using rivals::RayMatch;

// A match further than this many sigmas off its epipolar line is none.
constexpr double kEpipolarSigmas = 3.0;
// The vertical of the motion, where it is known, is far better than that of a plane through points this rough: a looser
// one would take a slice of a wall into the ground.
constexpr double kMaxTilt_rad = 0.02, kTiltSigmas = 3.0;
constexpr double kLessWell = 4.0;
// What features find again, at the same place of the pattern, and depth is told by: steps of this share of the distance
// to the board, aside rather than ahead, between views of nearly the same direction.
constexpr double kGoodStep = 0.12, kAhead = 0.1, kDirection_rad = 0.3;

/// What both images of a pair show, in the first one's frame.
struct SeenPoint {
  Eigen::Vector3d ray;  ///< in the first image, z = 1
  Eigen::Vector3d point;
};

/// Two images of a camera whose poses the board gives.
struct Step {
  const ViewPose &from, &to;
  Rigid3 T_from_to;
  double ray_sigma;  ///< of a match
};

using ViewsByPlace = std::map<std::pair<int, int>, const ViewPose*>;  // by stop and camera

const ViewPose* find_view(const ViewsByPlace& views, int stop, int camera) {
  const auto found = views.find({stop, camera});
  return found == views.end() ? nullptr : found->second;
}

double unlikeness(const ViewPose& a, const ViewPose& b) {
  const Rigid3 T_a_b = a.T_camera_board * b.T_camera_board.inverse();
  const double distance = a.T_camera_board.translation.norm();
  const double step = T_a_b.translation.norm() / distance, ahead = std::abs(T_a_b.translation.z()) / distance;
  const double direction_rad = std::acos(std::clamp(T_a_b.rotation.toRotationMatrix()(2, 2), -1.0, 1.0));
  return std::abs(std::log(std::max(step, 1e-6) / kGoodStep)) + ahead / kAhead + direction_rad / kDirection_rad;
}

// With each image that shows the board the other one that best shows the same floor from a little aside, whenever it
// was taken; no two twice, for they would tell the same again.
rivals::StopPairs partners(const ViewsByPlace& views, int camera, const std::vector<int>& stops) {
  rivals::StopPairs pairs;
  std::set<std::pair<int, int>> taken;
  for (const int stop : stops) {
    const ViewPose* from = find_view(views, stop, camera);
    const ViewPose* best = nullptr;
    double least = 0.0;
    for (const int other : stops) {
      const ViewPose* to = other == stop ? nullptr : find_view(views, other, camera);
      if (from == nullptr || to == nullptr || from->board != to->board || taken.count(std::minmax(stop, other)) > 0)
        continue;
      const double cost = unlikeness(*from, *to);
      if (best != nullptr && cost >= least) continue;
      best = to;
      least = cost;
    }
    if (best == nullptr) continue;
    pairs.emplace_back(stop, best->stop);
    taken.insert(std::minmax(stop, best->stop));
  }
  return pairs;
}

bool on_board(const Board& board, const ViewPose& seen, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = seen.T_camera_board.inverse() * point;
  const double margin = 2.0 * board.square_m;
  return std::abs(p.z()) < margin && p.x() > -margin && p.y() > -margin &&
         p.x() < board.square_m * board.squares_x + margin && p.y() < board.square_m * board.squares_y + margin;
}

// Matches on the board's epipolar geometry, from the top of the image downwards. What lies on the board is left out:
// a board near the floor is no floor. Nothing is chosen by the depth that was measured: it would be cut off on one
// side.
std::vector<SeenPoint> triangulate(const std::vector<RayMatch>& matches, const Step& step, const Board& board) {
  std::vector<SeenPoint> seen;
  for (const RayMatch& match : matches) {
    if (std::abs(rivals::sampson_error(step.T_from_to, match)) > kEpipolarSigmas * step.ray_sigma) continue;
    const auto point = rivals::triangulate(step.T_from_to, match);
    if (point && !on_board(board, step.from, *point)) seen.push_back({match.a, *point});
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const SeenPoint& p, const SeenPoint& q) { return p.ray.y() < q.ray.y(); });
  return seen;
}

// With what each point knows of 1/z: near the direction of the step, nearly nothing. How far away a point is matters
// there, too; a plane, once there is one, tells it better than the point itself, whose error would weigh itself.
DepthPoints with_sigmas(const std::vector<SeenPoint>& seen, const Step& between, double max_depth_m, double max_sigma,
                        const std::optional<PlaneObservation>& plane = std::nullopt) {
  const Eigen::Vector3d& step = between.T_from_to.translation;
  const double sigma = std::sqrt(2.0) * between.ray_sigma;
  DepthPoints points;
  points.max_m = max_depth_m;
  for (const SeenPoint& place : seen) {
    const double inverse_depth = plane ? plane->inverse_depth_plane.dot(place.ray) : 1.0 / place.point.z();
    if (!(inverse_depth > 0.0)) continue;
    const Eigen::Vector3d p = place.ray / inverse_depth;
    const double across = step.cross(place.ray.normalized()).norm();
    const double sigma_per_m =
        sigma * place.ray.norm() / std::max(across, 1e-9) * (p - step).squaredNorm() / p.squaredNorm();
    if (sigma_per_m > max_sigma * inverse_depth) continue;
    points.points.push_back(place.point.cast<float>());
    points.inverse_depth_sigmas_per_m.push_back(sigma_per_m);
  }
  return points;
}

GroundPlaneFit fit_ground(const std::vector<SeenPoint>& seen, const Step& step,
                          const std::optional<Eigen::Vector3d>& up, double max_tilt_rad,
                          const ImageGroundOptions& options) {
  GroundPlaneOptions plane_options;
  plane_options.min_inliers = options.min_points;
  if (up) plane_options.max_tilt_rad = max_tilt_rad;
  GroundPlaneFit fit;
  // Where points that are known well show no floor, and only there, those that are known less well.
  for (const double max_sigma : {options.max_depth_sigma, kLessWell * options.max_depth_sigma}) {
    const auto fit_to = [&](const DepthPoints& points) {
      return fit_ground_plane(points, DepthNoise(), up, plane_options);
    };
    const DepthPoints points = with_sigmas(seen, step, options.max_depth_m, max_sigma);
    fit = {std::nullopt,
           Finding("images.too_few_points", {{"points", points.points.size()}, {"matched", seen.size()}})};
    if (static_cast<int>(points.points.size()) < options.min_points) continue;
    fit = fit_to(points);
    if (fit.plane) fit = fit_to(with_sigmas(seen, step, options.max_depth_m, max_sigma, fit.plane));
    if (fit.plane) break;
  }
  return fit;
}

// The step's length is as uncertain as the two board poses; every depth of the pair scales with it.
Eigen::Matrix3d error_by_step(const Step& step, const Eigen::Vector3d& n) {
  const double length =
      (camera_position_in_board(step.from.T_camera_board) - camera_position_in_board(step.to.T_camera_board)).norm();
  const double variance =
      camera_position_covariance(step.from).trace() / 3.0 + camera_position_covariance(step.to).trace() / 3.0;
  return variance / (length * length) * n * n.transpose();
}

Exclusion no_ground(Exclusion exclusion) {
  exclusion.why = Finding("images.no_ground").by({exclusion.why});
  return exclusion;
}

// The planes of all pairs against the vertical and each other.
void vote(Observations voters, const TrajectoryAlignment& alignment, ImageGround* ground) {
  voters.ground_planes = ground->planes;
  const GroundCheck check = check_ground_planes(voters, alignment);
  ground->planes = check.planes(voters);
  for (const Exclusion& exclusion : check.rejected) ground->rejected.push_back(no_ground(exclusion));
}

}  // namespace

ImageGround ground_from_images(const MethodInput& input, const FeatureSource& source,
                               const ImageGroundOptions& options) {
  if (input.recording == nullptr) return {};
  const Observations& observations = input.observations;
  const std::vector<ViewPose> poses = estimate_view_poses(observations).poses;
  const TrajectoryAlignment alignment = align_trajectories(observations, poses);
  const double max_tilt_rad = kMaxTilt_rad + kTiltSigmas * alignment.sigma_up_rad;
  ViewsByPlace views;
  for (const ViewPose& view : poses) views[{view.stop, view.camera}] = &view;
  std::vector<bool> has_ground(observations.cameras.size(), false);
  for (const PlaneObservation& plane : observations.ground_planes)
    has_ground[static_cast<std::size_t>(plane.camera)] = true;
  const auto choose = [&](int camera, const std::vector<int>& stops) {
    return has_ground[static_cast<std::size_t>(camera)] ? rivals::StopPairs() : partners(views, camera, stops);
  };
  ImageGround ground;
  for (const ImagePair& pair : rivals::match_images(input, source, choose)) {
    throw_if_interrupted(input);
    const std::size_t camera = static_cast<std::size_t>(pair.camera);
    const ViewPose &from = *views.at({pair.from, pair.camera}), &to = *views.at({pair.to, pair.camera});
    const Step step{from, to, from.T_camera_board * to.T_camera_board.inverse(),
                    rivals::ray_sigma(observations.cameras[camera].camera, options.match_sigma_px)};
    const auto up = alignment.source == VerticalSource::kMotion ? alignment.up_camera[camera] : std::nullopt;
    const GroundPlaneFit fit =
        fit_ground(triangulate(pair.matches, step, observations.board_at(from.board)), step, up, max_tilt_rad, options);
    const std::string& file = observations.board_views[static_cast<std::size_t>(from.view)].file;
    if (!fit.plane) {
      ground.rejected.push_back(no_ground({pair.camera, pair.from, file, *fit.why_not, true}));
      continue;
    }
    PlaneObservation plane = *fit.plane;
    plane.stop = pair.from;
    plane.camera = pair.camera;
    plane.file = file;
    plane.covariance_per_m2 += error_by_step(step, plane.inverse_depth_plane);
    ground.planes.push_back(plane);
  }
  vote(observations, alignment, &ground);
  std::stable_sort(ground.planes.begin(), ground.planes.end(), [](const PlaneObservation& a, const auto& b) {
    return std::tie(a.stop, a.camera) < std::tie(b.stop, b.camera);
  });
  return ground;
}

}  // namespace rigproof
