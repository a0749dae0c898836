#include "rigproof/calib/image_ground.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "rigproof/calib/ground_plane.h"
#include "rigproof/calib/trajectory_alignment.h"
#include "rigproof/calib/view_poses.h"
#include "rigproof/core/conventions.h"
#include "rivals/image_pairs.h"

namespace rigproof {
namespace {

using rivals::ImagePair;
using rivals::RayMatch;

// A match further than this many sigmas off its epipolar line is none.
constexpr double kEpipolarSigmas = 3.0;
// The vertical of the motion, where it is known, is far better than that of a plane through points this rough: a looser
// one would take a slice of a wall into the ground.
constexpr double kMaxTilt_rad = 0.02, kTiltSigmas = 3.0;

/// Points of one pair of images in the first one's frame, with what they know of their inverse depth.
struct PairPoints {
  DepthPoints points;
  DepthNoise noise;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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
    const auto wanted = [&](int camera, int from, int to) {
      return !has_ground[static_cast<std::size_t>(camera)] && view(from, camera) && view(to, camera);
    };
    for (const ImagePair& pair : rivals::match_consecutive_images(input_, source_, wanted)) look_at(pair);
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
  const std::string& file_of(const ImagePair& pair) const {
    return observations_.board_views[static_cast<std::size_t>(view(pair.from, pair.camera)->view)].file;
  }

  // Matches on the board's epipolar geometry, at a parallax that tells their depth. What lies on the board is left
  // out: a board near the floor is no floor.
  PairPoints triangulate(const ImagePair& pair) const {
    const RigCamera& camera = observations_.cameras[static_cast<std::size_t>(pair.camera)];
    const double sigma = rivals::ray_sigma(camera.camera, options_.match_sigma_px);
    const ViewPose &a = *view(pair.from, pair.camera), &b = *view(pair.to, pair.camera);
    const Rigid3 T_a_b = a.T_camera_board * b.T_camera_board.inverse();
    PairPoints result;
    std::vector<double> sigmas;
    for (const RayMatch& match : pair.matches) {
      if (std::abs(rivals::sampson_error(T_a_b, match)) > kEpipolarSigmas * sigma) continue;
      const auto point = rivals::triangulate(T_a_b, match);
      if (!point || point->norm() > options_.max_distance_m || on_board(a, *point)) continue;
      const double parallax = angle_between(match.a, T_a_b.rotation * match.b);
      if (parallax < deg_to_rad(options_.min_parallax_deg)) continue;
      result.points.points.push_back(point->cast<float>());
      // 1/z along the ray moves by sigma over (range times the step's part across the ray): parallax = step / range.
      sigmas.push_back(std::sqrt(2.0) * sigma / (parallax * point->z()));
    }
    if (!sigmas.empty()) result.noise.inverse_depth_sigma_per_m = median(sigmas);
    return result;
  }

  static double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }

  bool on_board(const ViewPose& seen, const Eigen::Vector3d& point) const {
    const Eigen::Vector3d p = seen.T_camera_board.inverse() * point;
    const Board& board = observations_.board;
    const double margin = 2.0 * board.square_m;
    return std::abs(p.z()) < margin && p.x() > -margin && p.y() > -margin &&
           p.x() < board.square_m * board.squares_x + margin && p.y() < board.square_m * board.squares_y + margin;
  }

  void look_at(const ImagePair& pair) {
    PairPoints seen = triangulate(pair);
    // Rows of the image, as a depth image would give them.
    std::stable_sort(seen.points.points.begin(), seen.points.points.end(),
                     [](const Eigen::Vector3f& p, const Eigen::Vector3f& q) { return p.y() / p.z() < q.y() / q.z(); });
    const auto reject = [&](const std::string& reason) {
      result_.rejected.push_back({pair.camera, pair.from, file_of(pair), "ground from images: " + reason});
    };
    if (static_cast<int>(seen.points.points.size()) < options_.min_points)
      return reject(std::to_string(seen.points.points.size()) + " matched points");
    GroundPlaneOptions options;
    options.min_inliers = options_.min_points;
    const auto up = alignment_.source == VerticalSource::kMotion
                        ? alignment_.up_camera[static_cast<std::size_t>(pair.camera)]
                        : std::nullopt;
    if (up) options.max_tilt_rad = kMaxTilt_rad + kTiltSigmas * alignment_.sigma_up_rad;
    GroundPlaneFit fit = fit_ground_plane(seen.points, seen.noise, up, options);
    if (!fit.plane) return reject(fit.reason);
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
    std::vector<PlaneObservation> accepted;
    for (std::size_t i = 0; i < result_.planes.size(); ++i)
      if (check.accepted[i]) accepted.push_back(result_.planes[i]);
    result_.planes = std::move(accepted);
    for (Exclusion exclusion : check.rejected) {
      exclusion.reason = "ground from images: " + exclusion.reason;
      result_.rejected.push_back(exclusion);
    }
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
