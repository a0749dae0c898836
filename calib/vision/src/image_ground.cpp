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

class GroundFinder {
 public:
  GroundFinder(const MethodInput& input, const FeatureSource& source, const ImageGroundOptions& options)
      : input_(input),
        observations_(input.observations),
        source_(source),
        options_(options),
        views_(estimate_view_poses(observations_).poses),
        alignment_(align_trajectories(observations_, views_)) {
    for (const ViewPose& view : views_) boards_[{view.stop, view.camera}] = &view;
  }

  ImageGround find() {
    std::vector<bool> has_ground(observations_.cameras.size(), false);
    for (const PlaneObservation& plane : observations_.ground_planes)
      has_ground[static_cast<std::size_t>(plane.camera)] = true;
    const auto choose = [&](int camera, const std::vector<int>& stops) {
      return has_ground[static_cast<std::size_t>(camera)] ? rivals::StopPairs() : partners(camera, stops);
    };
    for (const ImagePair& pair : rivals::match_images(input_, source_, choose)) look_at(pair);
    vote();
    const auto before = [](const PlaneObservation& a, const PlaneObservation& b) {
      return std::tie(a.stop, a.camera) < std::tie(b.stop, b.camera);
    };
    std::stable_sort(result_.planes.begin(), result_.planes.end(), before);
    return std::move(result_);
  }

 private:
  const ViewPose* view(int stop, int camera) const {
    const auto found = boards_.find({stop, camera});
    return found == boards_.end() ? nullptr : found->second;
  }

  // With each image that shows the board the other one that best shows the same floor from a little aside, whenever it
  // was taken; no two twice, for they would tell the same again.
  rivals::StopPairs partners(int camera, const std::vector<int>& stops) const {
    rivals::StopPairs pairs;
    std::set<std::pair<int, int>> taken;
    for (const int stop : stops) {
      const ViewPose* from = view(stop, camera);
      const ViewPose* best = nullptr;
      double least = 0.0;
      for (const int other : stops) {
        const ViewPose* to = other == stop ? nullptr : view(other, camera);
        if (from == nullptr || to == nullptr || taken.count(std::minmax(stop, other)) > 0) continue;
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

  static double unlikeness(const ViewPose& a, const ViewPose& b) {
    const Rigid3 T_a_b = a.T_camera_board * b.T_camera_board.inverse();
    const double distance = a.T_camera_board.translation.norm();
    const double step = T_a_b.translation.norm() / distance, ahead = std::abs(T_a_b.translation.z()) / distance;
    const double direction_rad = std::acos(std::clamp(T_a_b.rotation.toRotationMatrix()(2, 2), -1.0, 1.0));
    return std::abs(std::log(std::max(step, 1e-6) / kGoodStep)) + ahead / kAhead + direction_rad / kDirection_rad;
  }

  const std::string& file_of(const ImagePair& pair) const {
    return observations_.board_views[static_cast<std::size_t>(view(pair.from, pair.camera)->view)].file;
  }

  Rigid3 step_of(const ImagePair& pair) const {
    return view(pair.from, pair.camera)->T_camera_board * view(pair.to, pair.camera)->T_camera_board.inverse();
  }
  double ray_sigma_of(const ImagePair& pair) const {
    const RigCamera& camera = observations_.cameras[static_cast<std::size_t>(pair.camera)];
    return rivals::ray_sigma(camera.camera, options_.match_sigma_px);
  }

  // Matches on the board's epipolar geometry, from the top of the image downwards. What lies on the board is left out:
  // a board near the floor is no floor. Nothing is chosen by the depth that was measured: it would be cut off on one
  // side.
  std::vector<SeenPoint> triangulate(const ImagePair& pair) const {
    const Rigid3 T_a_b = step_of(pair);
    const double sigma = ray_sigma_of(pair);
    std::vector<SeenPoint> seen;
    for (const RayMatch& match : pair.matches) {
      if (std::abs(rivals::sampson_error(T_a_b, match)) > kEpipolarSigmas * sigma) continue;
      const auto point = rivals::triangulate(T_a_b, match);
      if (point && !on_board(*view(pair.from, pair.camera), *point)) seen.push_back({match.a, *point});
    }
    std::stable_sort(seen.begin(), seen.end(),
                     [](const SeenPoint& p, const SeenPoint& q) { return p.ray.y() < q.ray.y(); });
    return seen;
  }

  // With what each point knows of 1/z: near the direction of the step, nearly nothing. How far away a point is matters
  // there, too; a plane, once there is one, tells it better than the point itself, whose error would weigh itself.
  DepthPoints with_sigmas(const ImagePair& pair, const std::vector<SeenPoint>& seen,
                          const std::optional<PlaneObservation>& plane, double max_sigma) const {
    const Eigen::Vector3d step = step_of(pair).translation;
    const double sigma = std::sqrt(2.0) * ray_sigma_of(pair);
    DepthPoints points;
    points.max_m = options_.max_depth_m;
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

  bool on_board(const ViewPose& seen, const Eigen::Vector3d& point) const {
    const Eigen::Vector3d p = seen.T_camera_board.inverse() * point;
    const Board& board = observations_.board;
    const double margin = 2.0 * board.square_m;
    return std::abs(p.z()) < margin && p.x() > -margin && p.y() > -margin &&
           p.x() < board.square_m * board.squares_x + margin && p.y() < board.square_m * board.squares_y + margin;
  }

  void look_at(const ImagePair& pair) {
    throw_if_interrupted(input_);
    const std::vector<SeenPoint> seen = triangulate(pair);
    const auto reject = [&](const Finding& why) {
      result_.rejected.push_back(no_ground({pair.camera, pair.from, file_of(pair), why, true}));
    };
    GroundPlaneOptions options;
    options.min_inliers = options_.min_points;
    const auto up = alignment_.source == VerticalSource::kMotion
                        ? alignment_.up_camera[static_cast<std::size_t>(pair.camera)]
                        : std::nullopt;
    if (up) options.max_tilt_rad = kMaxTilt_rad + kTiltSigmas * alignment_.sigma_up_rad;
    GroundPlaneFit fit;
    // Where points that are known well show no floor, and only there, those that are known less well.
    for (const double max_sigma : {options_.max_depth_sigma, kLessWell * options_.max_depth_sigma}) {
      const DepthPoints points = with_sigmas(pair, seen, std::nullopt, max_sigma);
      fit = GroundPlaneFit();
      fit.why_not = Finding("images.too_few_points", {{"points", points.points.size()}, {"matched", seen.size()}});
      if (static_cast<int>(points.points.size()) < options_.min_points) continue;
      fit = fit_ground_plane(points, DepthNoise(), up, options);
      if (fit.plane) fit = fit_ground_plane(with_sigmas(pair, seen, fit.plane, max_sigma), DepthNoise(), up, options);
      if (fit.plane) break;
    }
    if (!fit.plane) return reject(*fit.why_not);
    PlaneObservation plane = *fit.plane;
    plane.stop = pair.from;
    plane.camera = pair.camera;
    plane.file = file_of(pair);
    add_step_error(pair, &plane);
    result_.planes.push_back(plane);
  }

  // The step's length is as uncertain as the two board poses; every depth of the pair scales with it.
  void add_step_error(const ImagePair& pair, PlaneObservation* plane) const {
    const ViewPose &a = *view(pair.from, pair.camera), &b = *view(pair.to, pair.camera);
    const double step =
        (camera_position_in_board(a.T_camera_board) - camera_position_in_board(b.T_camera_board)).norm();
    const double variance = camera_position_covariance(a).trace() / 3.0 + camera_position_covariance(b).trace() / 3.0;
    const Eigen::Vector3d& n = plane->inverse_depth_plane;
    plane->covariance_per_m2 += variance / (step * step) * n * n.transpose();
  }

  // The planes of all pairs against the vertical and each other.
  void vote() {
    Observations voters = observations_;
    voters.ground_planes = result_.planes;
    const GroundCheck check = check_ground_planes(voters, alignment_);
    result_.planes = check.planes(voters);
    for (const Exclusion& exclusion : check.rejected) result_.rejected.push_back(no_ground(exclusion));
  }

  static Exclusion no_ground(Exclusion exclusion) {
    exclusion.why = Finding("images.no_ground").by({exclusion.why});
    return exclusion;
  }

  const MethodInput& input_;
  const Observations& observations_;
  const FeatureSource& source_;
  const ImageGroundOptions& options_;
  const std::vector<ViewPose> views_;
  const TrajectoryAlignment alignment_;
  std::map<std::pair<int, int>, const ViewPose*> boards_;
  ImageGround result_;
};

}  // namespace

ImageGround ground_from_images(const MethodInput& input, const FeatureSource& source,
                               const ImageGroundOptions& options) {
  if (input.recording == nullptr) return {};
  return GroundFinder(input, source, options).find();
}

}  // namespace rigproof
