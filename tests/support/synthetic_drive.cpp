#include "synthetic_drive.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "looking_forward.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/draw_vector.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d normal3(RandomStream& random, double sigma) {
  return {random.normal(0.0, sigma), random.normal(0.0, sigma), random.normal(0.0, sigma)};
}

Eigen::Quaterniond any_rotation(RandomStream& random) {
  const Eigen::Vector4d wxyz = draw_vector<4>([&] { return random.normal(); });
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized();
}

class Maker {
 public:
  Maker(const DriveOptions& options, std::int64_t attempt)
      : options_(options), random_(options.seed, "synthetic drive", attempt) {}

  std::optional<SyntheticDrive> make() {
    mount_cameras();
    put_board();
    if (!drive()) return std::nullopt;
    observe();
    return drive_;
  }

 private:
  void mount_cameras() {
    const double z = random_.uniform(0.5, 1.0), y = random_.uniform(-0.3, 0.3), x = random_.uniform(-0.3, 0.4);
    const Vector3d place(x, y, z);
    const Eigen::Quaterniond pitch(Eigen::AngleAxisd(random_.uniform(-0.1, 0.3), Vector3d::UnitY()));
    const Eigen::Quaterniond first = options_.any_mounting ? any_rotation(random_) : pitch * looking_forward();
    for (int k = 0; k < options_.cameras; ++k) {
      const double side = options_.overlap ? 0.0 : 2.0 * kPi * k / options_.cameras;
      const Eigen::Quaterniond jitter = so3_exp(k == 0 ? Vector3d(Vector3d::Zero()) : normal3(random_, 0.08));
      const double up = random_.uniform(-0.2, 0.2), left = random_.uniform(-0.3, 0.3);
      const Vector3d offset(0.0, left, up);
      drive_.T_robot_camera.emplace_back(rotation_z(side) * first * jitter, rotation_z(side) * (place + offset));
      sides_.push_back(side);
    }
  }

  // In front of the first camera at the first pose, facing it with up to 35 degrees of obliquity, any turn in its
  // plane.
  void put_board() {
    const Board board;
    const double roll = options_.any_mounting ? random_.uniform(-kPi, kPi) : random_.uniform(-0.1, 0.1);
    const Vector2d lean = draw_vector<2>([this] { return random_.uniform(-0.4, 0.4); });
    const Eigen::Quaterniond R = so3_exp(Vector3d(lean.x(), lean.y(), 0.0)) * so3_exp(Vector3d(0.0, 0.0, roll));
    const double z = random_.uniform(1.6, 2.4), y = random_.uniform(-0.15, 0.15), x = random_.uniform(-0.2, 0.2);
    const Vector3d centre(x, y, z);
    const Rigid3 T_camera_board(R, centre - R * board.centre());
    drive_.T_world_board = drive_.T_robot_camera.front() * T_camera_board;
  }

  Rigid3 candidate(int attempt, double side) {
    switch (options_.kind) {
      case DriveKind::kStraight:
        return planar_pose(random_.uniform(-0.8, 0.8), 0.0, 0.0);
      case DriveKind::kInPlace:
        return planar_pose(0.0, 0.0, random_.uniform(-0.5, 0.5) - side);
      case DriveKind::kArc: {
        const Rigid3 T_robot_centre = planar_pose(arc_centre().x(), arc_centre().y(), 0.0);
        return T_robot_centre * planar_pose(0.0, 0.0, random_.uniform(-0.5, 0.5)) * T_robot_centre.inverse();
      }
      case DriveKind::kStandstill:
        return Rigid3();
      case DriveKind::kRandom:
        break;
    }
    if (attempt == 0) return Rigid3();
    const double yaw = random_.uniform(-0.5, 0.5), y = random_.uniform(-0.8, 0.8), x = random_.uniform(-0.8, 0.8);
    return planar_pose(x, y, yaw) * planar_pose(0.0, 0.0, -side);
  }

  Vector2d arc_centre() const { return {-0.02, 1.79}; }

  bool drive() {
    for (int attempt = 0; attempt < 60 * options_.stops && stop_count() < options_.stops; ++attempt) {
      const std::size_t k = drive_.T_world_robot.size() % sides_.size();
      const Rigid3 pose = candidate(attempt, sides_[k]);
      bool seen = false;
      for (const Rigid3& X : drive_.T_robot_camera) seen = seen || sees(X, pose);
      if (seen) drive_.T_world_robot.push_back(pose);
    }
    return stop_count() == options_.stops;
  }

  int stop_count() const { return static_cast<int>(drive_.T_world_robot.size()); }

  bool sees(const Rigid3& X, const Rigid3& pose) const {
    const Rigid3 T_camera_board = (pose * X).inverse() * drive_.T_world_board;
    // Nearer than 70 degrees to grazing a detector sees nothing.
    const Vector3d centre = T_camera_board * Board().centre();
    const double facing = (T_camera_board.rotation * Vector3d::UnitZ()).dot(centre.normalized());
    if (facing < 0.35) return false;
    for (const Vector3d& corner : Board().corners()) {
      Vector2d pixel;
      if (!camera_.project(T_camera_board * corner, &pixel) || !camera_.contains(pixel)) return false;
    }
    return true;
  }

  void observe() {
    Observations& o = drive_.observations;
    o.board.believe();
    for (int k = 0; k < options_.cameras; ++k) {
      RigCamera camera;
      camera.name = "camera" + std::to_string(k);
      camera.camera = camera_;
      camera.intrinsics_sigma = IntrinsicsSigma::exact();
      o.cameras.push_back(camera);
    }
    // The world is the robot's frame at the first stop.
    const Rigid3 T_first_world = drive_.T_world_robot.front().inverse();
    drive_.T_world_board = T_first_world * drive_.T_world_board;
    for (Rigid3& pose : drive_.T_world_robot) pose = T_first_world * pose;
    add_odometry();
    for (int i = 0; i < stop_count(); ++i)
      for (int k = 0; k < options_.cameras; ++k) add_view(i, k);
  }

  void add_odometry() {
    Rigid3 pose;
    for (std::size_t i = 0; i < drive_.T_world_robot.size(); ++i) {
      if (i > 0) {
        const Rigid3 step = drive_.T_world_robot[i - 1].inverse() * drive_.T_world_robot[i];
        const double yaw = yaw_of(step) + random_.normal(0.0, options_.odometry_sigma_rad);
        const Vector2d noise = draw_vector<2>([this] { return random_.normal(0.0, options_.odometry_sigma_m); });
        pose = pose * planar_pose(step.translation.x() + noise.x(), step.translation.y() + noise.y(), yaw);
      }
      const double stamp = static_cast<double>(i);
      drive_.observations.stops.push_back({stamp, pose.translation.x(), pose.translation.y(), yaw_of(pose), 0.0});
    }
  }

  void add_view(int stop, int k) {
    const Rigid3& X = drive_.T_robot_camera[static_cast<std::size_t>(k)];
    const Rigid3& pose = drive_.T_world_robot[static_cast<std::size_t>(stop)];
    if (!sees(X, pose)) return;
    const Rigid3 T_camera_board = (pose * X).inverse() * drive_.T_world_board;
    BoardView view{stop, k, static_cast<double>(stop), file_name(stop, k), {}};
    ViewPose view_pose;
    view_pose.view = static_cast<int>(drive_.observations.board_views.size());
    view_pose.stop = stop;
    view_pose.camera = k;
    add_corners(T_camera_board, &view, &view_pose);
    drive_.observations.board_views.push_back(view);
    drive_.views.push_back(view_pose);
    if (options_.ground) add_plane(stop, k);
  }

  static std::string file_name(int stop, int k) { return std::to_string(k) + "/" + std::to_string(stop) + ".png"; }

  void add_corners(const Rigid3& T_camera_board, BoardView* view, ViewPose* view_pose) {
    const double sigma = std::max(options_.corner_sigma_px, 0.003);
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    for (int id = 0; id < Board().corner_count(); ++id) {
      const Vector3d rotated = T_camera_board.rotation * Board().corner(id);
      Vector2d pixel;
      Eigen::Matrix<double, 2, 3> J_point;
      camera_.project(rotated + T_camera_board.translation, &pixel, &J_point);
      const Vector2d noise = draw_vector<2>([this] { return random_.normal(0.0, options_.corner_sigma_px); });
      view->corners.push_back({id, pixel + noise, sigma * sigma * Eigen::Matrix2d::Identity()});
      Eigen::Matrix<double, 2, 6> J;
      J << J_point, -J_point * skew(rotated);
      H += J.transpose() * J;
      g += J.transpose() * noise;
    }
    const Eigen::LDLT<Matrix6d> solver(H);
    view_pose->T_camera_board = apply_transform_error(T_camera_board, solver.solve(g));
    view_pose->covariance = sigma * sigma * solver.solve(Matrix6d::Identity());
    view_pose->reprojection_rms_px = options_.corner_sigma_px;
  }

  void add_plane(int stop, int k) {
    const Rigid3& X = drive_.T_robot_camera[static_cast<std::size_t>(k)];
    PlaneObservation plane;
    plane.stop = stop;
    plane.camera = k;
    plane.file = file_name(stop, k);
    const Vector3d noise = normal3(random_, options_.plane_sigma_per_m);
    plane.inverse_depth_plane = -(X.rotation.conjugate() * Vector3d::UnitZ()) / X.translation.z() + noise;
    const double sigma = std::max(options_.plane_sigma_per_m, 1e-6);
    plane.covariance_per_m2 = sigma * sigma * Eigen::Matrix3d::Identity();
    plane.effective_points = 300.0;
    plane.inlier_points = 3000;
    plane.residual_rms = 1.0;
    drive_.observations.ground_planes.push_back(plane);
  }

  const DriveOptions options_;
  RandomStream random_;
  const Camera camera_ = Camera::symmetric(1280, 720, 640.0);
  std::vector<double> sides_;
  SyntheticDrive drive_;
};

}  // namespace

DriveOptions any_mounting(std::uint64_t seed, int most_cameras) {
  DriveOptions options;
  options.seed = seed;
  options.any_mounting = true;
  options.cameras = 1 + static_cast<int>(seed % static_cast<std::uint64_t>(most_cameras));
  options.overlap = seed % 3 != 0;
  return options;
}

SyntheticDrive make_drive(const DriveOptions& options) {
  for (std::int64_t attempt = 0; attempt < 1000; ++attempt)
    if (std::optional<SyntheticDrive> drive = Maker(options, attempt).make()) return *drive;
  throw std::logic_error("no rig of this seed sees the board often enough");
}

}  // namespace rigproof
