#include "synthetic.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "rigproof/core/conventions.h"
#include "rigproof/core/draw_vector.h"
#include "rigproof/validate/body_angles.h"

namespace rigproof::testing_support {

Rigid3 looking(const Eigen::Vector3d& place_m, double yaw_deg, double down_deg, double roll_deg) {
  const Eigen::Vector3d angles(deg_to_rad(roll_deg), deg_to_rad(down_deg), deg_to_rad(yaw_deg));
  return Rigid3(from_roll_pitch_yaw(angles) * optical_from_body().conjugate(), place_m);
}

Truth make_truth(std::size_t stops) {
  Truth truth;
  truth.scene = "synthetic";
  truth.board.believe();
  const Camera camera = Camera::symmetric(640, 360, 320.0);
  truth.cameras = {{"left", looking({0.31, 0.24, 0.62}, 25.0, 12.0, 1.0), camera, 1.0, {}},
                   {"center", looking({0.36, 0.02, 0.64}, -1.0, 10.0, -0.5), camera, 1.0, {}},
                   {"right", looking({0.30, -0.25, 0.61}, -27.0, 14.0, 0.7), camera, 1.0, {}}};
  // The board hangs upright 3 m ahead: x to the right, y down, z away from the robot.
  truth.T_world_board = looking({3.0, 0.15, 0.9}, 3.0, 2.0);
  for (std::size_t i = 0; i < stops; ++i) {
    const double k = static_cast<double>(i);
    Rigid3 T = planar_pose(0.9 * std::sin(1.3 * k) + 0.4, 0.7 * std::cos(2.1 * k), 0.5 * std::sin(1.7 * k));
    T = T * Rigid3(so3_exp({0.002 * std::sin(k), 0.002 * std::cos(k), 0.0}), {0.0, 0.0, 0.001 * std::sin(2.0 * k)});
    truth.stops.push_back({10.0 + 2.0 * k, T});
  }
  return truth;
}

Result make_result(const Truth& truth, const std::vector<Vector6d>& errors) {
  Result result;
  result.method = "synthetic";
  result.status = ResultStatus::kSolved;
  for (std::size_t i = 0; i < truth.cameras.size(); ++i) {
    EstimatedTransform estimate;
    estimate.parent = "base_footprint";
    estimate.child = truth.cameras[i].name;
    estimate.T_parent_child = apply_transform_error(truth.cameras[i].T_robot_camera, errors[i]);
    result.camera_to_robot.push_back(estimate);
  }
  return result;
}

Result exact_result(const Truth& truth) {
  return make_result(truth, std::vector<Vector6d>(truth.cameras.size(), Vector6d::Zero()));
}

Eigen::MatrixXd random_covariance(const Eigen::VectorXd& sigmas, RandomStream& random) {
  const Eigen::Index n = sigmas.size();
  Eigen::MatrixXd A(n, n);
  for (Eigen::Index i = 0; i < A.size(); ++i) A.data()[i] = 0.5 * random.normal() / std::sqrt(static_cast<double>(n));
  A.diagonal().array() += 1.0;
  const Eigen::MatrixXd scaled = sigmas.asDiagonal() * A;
  return scaled * scaled.transpose();
}

Eigen::VectorXd draw(const Eigen::MatrixXd& covariance, RandomStream& random) {
  Eigen::VectorXd unit(covariance.rows());
  for (double& value : unit) value = random.normal();
  return covariance.llt().matrixL() * unit;
}

namespace {

std::vector<CornerObservation> view_of(const Truth& truth, std::size_t stop, std::size_t camera, double sigma_px,
                                       std::uint64_t seed) {
  RandomStream random(seed, "corners", static_cast<std::int64_t>(stop), static_cast<std::int32_t>(camera));
  const TrueCamera& c = truth.cameras[camera];
  const Rigid3 T_camera_board = (truth.stops[stop].T_world_robot * c.T_robot_camera).inverse() * truth.T_world_board;
  std::vector<CornerObservation> corners;
  for (int id = 0; id < truth.board.corner_count(); ++id) {
    CornerObservation corner;
    corner.id = id;
    if (!c.camera.project(T_camera_board * truth.corner(id), &corner.pixel)) return {};
    if (!c.camera.contains(corner.pixel, 5.0)) return {};
    corner.pixel += sigma_px * draw_vector<2>([&random] { return random.normal(); });
    corner.covariance_px2 = sigma_px * sigma_px * Eigen::Matrix2d::Identity();
    corners.push_back(corner);
  }
  return corners;
}

RigCamera rig_camera_of(const TrueCamera& camera) {
  RigCamera rig_camera;
  rig_camera.name = rig_camera.folder = camera.name;
  rig_camera.camera = camera.camera;
  rig_camera.intrinsics_sigma = IntrinsicsSigma::exact();
  rig_camera.depth = DepthStream();
  rig_camera.depth->noise.believe_place_and_common_scale();
  return rig_camera;
}

// z at which a ray meets the squares of the board or the ground, whichever is nearer; 0 for the sky.
double true_depth(const Truth& truth, const Rigid3& T_world_camera, const Eigen::Vector3d& ray, double bow_m) {
  const Rigid3 T_board_camera = truth.T_world_board.inverse() * T_world_camera;
  double nearest = std::numeric_limits<double>::infinity();
  double board_z = 0.0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int round = 0; round < 20; ++round) {
    const double height = round == 0 ? 0.0 : bowed_z_m(truth.board, bow_m, p.x());
    board_z = (height - T_board_camera.translation.z()) / (T_board_camera.rotation * ray).z();
    p = T_board_camera * (board_z * ray);
  }
  const double s = truth.board.square_m;
  if (board_z > 0.0 && p.x() > -s && p.y() > -s && p.x() < s * truth.board.inner_corners_x() &&
      p.y() < s * truth.board.inner_corners_y())
    nearest = board_z;
  const double ground_z = -T_world_camera.translation.z() / (T_world_camera.rotation * ray).z();
  if (ground_z > 0.0) nearest = std::min(nearest, ground_z);
  return std::isfinite(nearest) && nearest < 8.0 ? nearest : 0.0;
}

cv::Mat depth_image(const Truth& truth, std::size_t stop, std::size_t camera, const DepthFaults& faults) {
  const TrueCamera& c = truth.cameras[camera];
  const Rigid3 T_world_camera = truth.stops[stop].T_world_robot * c.T_robot_camera;
  RandomStream random(3, "depth", static_cast<std::int64_t>(stop), static_cast<std::int32_t>(camera));
  const DepthStream stream;
  cv::Mat image(c.camera.height_px, c.camera.width_px, CV_16UC1, cv::Scalar(0));
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      Eigen::Vector3d ray;
      c.camera.unproject({u, v}, &ray);
      double z = true_depth(truth, T_world_camera, ray, faults.bow_m) * (faults.along_ray ? ray.norm() : 1.0);
      if (faults.noise_sigmas > 0.0) z += faults.noise_sigmas * stream.noise.sigma_m(z) * random.normal();
      const double outward = 1.0 - 4.0 * u / image.cols;
      const bool is_ground = std::abs((T_world_camera * (z * ray)).z()) < 1e-9;
      if (faults.furniture && is_ground && outward > 0.0) z *= 1.0 - 0.3 * outward;
      const double counts = std::round(faults.factor * z / stream.unit_m);
      const int row = faults.mirrored_y ? image.rows - 1 - v : v;
      image.at<std::uint16_t>(row, u) = static_cast<std::uint16_t>(std::min(65535.0, std::max(0.0, counts)));
    }
  }
  return image;
}

}  // namespace

Observations make_observations(const Truth& truth, double sigma_px, std::uint64_t seed) {
  Observations observations;
  observations.board = truth.board;
  for (const TrueCamera& camera : truth.cameras) observations.cameras.push_back(rig_camera_of(camera));
  for (std::size_t stop = 0; stop < truth.stops.size(); ++stop) {
    const Rigid3& T = truth.stops[stop].T_world_robot;
    observations.stops.push_back({truth.stops[stop].stamp_s, T.translation.x(), T.translation.y(), yaw_of(T), 0.0});
    for (std::size_t camera = 0; camera < truth.cameras.size(); ++camera) {
      const std::vector<CornerObservation> corners = view_of(truth, stop, camera, sigma_px, seed);
      if (corners.empty()) continue;
      observations.board_views.push_back({static_cast<int>(stop), static_cast<int>(camera), truth.stops[stop].stamp_s,
                                          truth.cameras[camera].name + "/" + std::to_string(stop) + ".png", corners});
    }
  }
  return observations;
}

double bowed_z_m(const Board& board, double bow_m, double x_m) {
  const double half = 0.5 * board.square_m * board.squares_x, across = (x_m - board.centre().x()) / half;
  return -bow_m * (1.0 - across * across);
}

Recording make_depth_recording(const Truth& truth, const std::filesystem::path& folder, const DepthFaults& faults) {
  Recording recording;
  recording.folder = folder;
  recording.rig.board = truth.board;
  for (std::size_t camera = 0; camera < truth.cameras.size(); ++camera) {
    recording.rig.cameras.push_back(rig_camera_of(truth.cameras[camera]));
    recording.frames.emplace_back();
    for (std::size_t stop = 0; stop < truth.stops.size(); ++stop) {
      CameraFrame frame;
      frame.stamp_s = truth.stops[stop].stamp_s;
      frame.depth_file = truth.cameras[camera].name + "_" + std::to_string(stop) + ".png";
      cv::imwrite((folder / frame.depth_file).string(), depth_image(truth, stop, camera, faults));
      recording.frames.back().push_back(frame);
    }
  }
  return recording;
}

}  // namespace rigproof::testing_support
