#include "rigproof/geometric/geometric.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>
#include <utility>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

// The paper's noise at lambda 1.
constexpr double kPaperTranslationSigma_m = 0.002;
constexpr double kPaperYawSigma_rad = 0.01;

constexpr double kStopInterval_s = 2.0;
constexpr double kMinGroundDepth_m = 0.3;
constexpr double kMaxGroundDepth_m = 6.0;

// Rays at which a depth camera samples a plane; a grid stands for the many pixels of the real image.
constexpr int kGridColumns = 16;
constexpr int kGridRows = 9;
constexpr int kMinRaysOnGround = 8;
// Depth so near the board's edge is not taken for the board's [squares].
constexpr double kBoardEdge = 0.25;

void check(const GeometricConfig& config) {
  Problems problems;
  const auto require = [&problems](bool holds, const char* field, double value, const char* message) {
    if (!holds) problems.add({"", 0, field, std::to_string(value), message});
  };
  require(config.stops >= 1, "stops", config.stops, "must be at least 1");
  require(config.corner_sigma_px >= 0.0, "corner_sigma_px", config.corner_sigma_px, "must not be negative");
  require(config.lambda >= 0.0, "lambda", config.lambda, "must not be negative");
  require(!config.rig.cameras.empty(), "rig.cameras", 0, "at least one camera is needed");
  require(config.rig.cameras.size() == config.rig.T_robot_camera.size(), "rig.T_robot_camera",
          static_cast<double>(config.rig.T_robot_camera.size()), "one pose a camera is needed");
  require(config.odometry_model != OdometryModel::kUnknown, "odometry_model", 0, "must be per_pose or per_increment");
  problems.throw_if_any();
}

// The middle of piece i of so many, in squares from the first inner corner.
double inside_board(int i, int pieces, int squares) {
  return kBoardEdge + (squares - 2.0 * kBoardEdge) * (i + 0.5) / pieces - 1.0;
}

class Drawer {
 public:
  Drawer(const GeometricConfig& config, GeometricScene scene) : config_(config), scene_(std::move(scene)) {}

  GeometricRun draw() {
    describe();
    for (std::size_t i = 0; i < scene_.T_world_robot.size(); ++i) {
      run_.truth.stops.push_back({kStopInterval_s * static_cast<double>(i), scene_.T_world_robot[i]});
      for (std::size_t c = 0; c < config_.rig.cameras.size(); ++c) draw_frame(static_cast<int>(i), static_cast<int>(c));
    }
    draw_odometry();
    return std::move(run_);
  }

 private:
  void describe() {
    Observations& observations = run_.observations;
    observations.source = "geometric mode, seed " + std::to_string(config_.seed);
    observations.board = config_.rig.board;
    observations.cameras = config_.rig.cameras;
    Truth& truth = run_.truth;
    truth.scene = "geometric";
    truth.seed = config_.seed;
    truth.board = config_.rig.board;
    truth.T_world_board = scene_.T_world_board;
    truth.odometry_noise = paper_odometry_noise(config_.odometry_model, config_.lambda);
    truth.odometry_scale = config_.odometry_scale;
    truth.odometry_yaw_factor = config_.odometry_yaw_factor;
    for (std::size_t c = 0; c < config_.rig.cameras.size(); ++c) {
      RigCamera& camera = observations.cameras[c];
      truth.cameras.push_back({camera.name, config_.rig.T_robot_camera[c], camera.camera, depth_scale_of(c), {}});
      if (!camera.depth) continue;
      camera.depth->noise.bias_inverse_depth_per_m = camera.depth->noise.bias_m = 0.0;  // none is drawn
      if (config_.measured.empty()) camera.depth->noise.inverse_depth_sigma_per_m = config_.inverse_depth_sigma_per_m;
      if (config_.depth_scales.empty())
        camera.depth->noise.scale_sigma = config_.depth_scale_sigma;  // what is true is declared
    }
    if (config_.declare_odometry_model) observations.odometry_noise.model = config_.odometry_model;
    if (config_.declare_odometry_sigmas) {
      observations.odometry_noise.sigma_xy_m = truth.odometry_noise.sigma_xy_m;
      observations.odometry_noise.sigma_yaw_rad = truth.odometry_noise.sigma_yaw_rad;
    }
  }

  double depth_scale_of(std::size_t camera) const {
    if (!config_.depth_scales.empty()) return config_.depth_scales[camera];
    RandomStream random(config_.seed, "geometric depth scale", -1, static_cast<std::int32_t>(camera));
    return 1.0 + random.normal(0.0, config_.depth_scale_sigma);
  }

  // The configuration's figures for all cameras, or what was measured of this one.
  GeometricNoise noise_of(int camera) const {
    if (!config_.measured.empty()) return config_.measured[static_cast<std::size_t>(camera)];
    GeometricNoise noise;
    noise.corner_sigma_px = config_.corner_sigma_px;
    const double sigma = config_.inverse_depth_sigma_per_m;
    if (config_.ground) noise.ground_sigma_per_m = sigma;
    if (config_.board_planes) noise.board_sigma_per_m = sigma;
    noise.ground_points = config_.ground_points;
    noise.board_points = config_.board_points;
    return noise;
  }

  Rigid3 T_world_camera(int stop, int camera) const {
    return scene_.T_world_robot[static_cast<std::size_t>(stop)] *
           config_.rig.T_robot_camera[static_cast<std::size_t>(camera)];
  }

  void draw_frame(int stop, int camera) {
    const Rigid3 T_camera_world = T_world_camera(stop, camera).inverse();
    const Rigid3 T_camera_board = T_camera_world * scene_.T_world_board;
    const bool seen = draw_corners(stop, camera, T_camera_board);
    if (!config_.rig.cameras[static_cast<std::size_t>(camera)].depth) return;
    const GeometricNoise noise = noise_of(camera);
    if (noise.ground_sigma_per_m) draw_ground(stop, camera, T_camera_world, noise);
    if (seen && noise.board_sigma_per_m) draw_board_plane(stop, camera, T_camera_board, noise);
  }

  bool draw_corners(int stop, int camera, const Rigid3& T_camera_board) {
    const Camera& lens = config_.rig.cameras[static_cast<std::size_t>(camera)].camera;
    if ((T_camera_board.rotation * Eigen::Vector3d::UnitZ()).dot(T_camera_board * config_.rig.board.centre()) <= 0.0)
      return false;
    RandomStream random(config_.seed, "geometric corners", stop, camera);
    BoardView view;
    view.stop = stop;
    view.camera = camera;
    view.stamp_s = kStopInterval_s * stop;
    const double floor_px = 1e-3;  // a covariance must be positive, even where no noise is drawn
    const double sigma_px = noise_of(camera).corner_sigma_px, stated_px = std::max(sigma_px, floor_px);
    for (int id = 0; id < config_.rig.board.corner_count(); ++id) {
      CornerObservation corner;
      corner.id = id;
      if (!lens.project(T_camera_board * config_.rig.board.corner(id), &corner.pixel)) return false;
      if (!lens.contains(corner.pixel)) return false;
      corner.pixel += sigma_px * Eigen::Vector2d(random.normal(), random.normal());
      corner.covariance_px2 = stated_px * stated_px * Eigen::Matrix2d::Identity();
      if (random.uniform() < config_.corner_outlier_fraction)
        corner.pixel += Eigen::Vector2d(random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0));
      view.corners.push_back(corner);
    }
    run_.observations.board_views.push_back(std::move(view));
    return true;
  }

  void draw_ground(int stop, int camera, const Rigid3& T_camera_world, const GeometricNoise& noise) {
    const Eigen::Vector3d up = T_camera_world.rotation * Eigen::Vector3d::UnitZ();
    const double height = -up.dot(T_camera_world.translation);
    const Camera& lens = config_.rig.cameras[static_cast<std::size_t>(camera)].camera;
    const std::optional<RayMoments> moments = ground_ray_moments(lens, -up / height);
    if (!moments) return;
    run_.observations.ground_planes.push_back(plane("geometric ground", stop, camera, -up / height, *moments,
                                                    *noise.ground_sigma_per_m, noise.ground_points));
  }

  void draw_board_plane(int stop, int camera, const Rigid3& T_camera_board, const GeometricNoise& noise) {
    const Eigen::Vector3d normal = T_camera_board.rotation * Eigen::Vector3d::UnitZ();
    const double distance = normal.dot(T_camera_board.translation);
    const Camera& lens = config_.rig.cameras[static_cast<std::size_t>(camera)].camera;
    const RayMoments moments = board_ray_moments(lens, config_.rig.board, T_camera_board);
    run_.observations.board_planes.push_back(plane("geometric board plane", stop, camera, normal / distance, moments,
                                                   *noise.board_sigma_per_m, noise.board_points));
  }

  PlaneObservation plane(const char* purpose, int stop, int camera, const Eigen::Vector3d& a, const RayMoments& moments,
                         double sigma, double points) {
    RandomStream random(config_.seed, purpose, stop, camera);
    PlaneObservation observation;
    observation.stop = stop;
    observation.camera = camera;
    const double stated = std::max(sigma, 1e-6), effective = points > 0.0 ? points : moments.pixels;
    observation.covariance_per_m2 = stated * stated * (moments.mean * effective).inverse();
    const Eigen::Matrix3d L = observation.covariance_per_m2.llt().matrixL();
    const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    const double depth_scale = *run_.truth.cameras[static_cast<std::size_t>(camera)].depth_scale;
    observation.inverse_depth_plane = a / depth_scale + (sigma > 0.0 ? 1.0 : 0.0) * (L * noise);
    if (random.uniform() < config_.plane_outlier_fraction) {
      const Eigen::Vector3d tilt(random.normal(0.0, 0.1), random.normal(0.0, 0.1), random.normal(0.0, 0.1));
      observation.inverse_depth_plane = random.uniform(0.7, 1.4) * (so3_exp(tilt) * observation.inverse_depth_plane);
    }
    observation.effective_points = effective;
    observation.inlier_points = static_cast<int>(effective);
    observation.residual_rms = 1.0;
    return observation;
  }

  void draw_odometry() {
    if (config_.odometry_model == OdometryModel::kPerPose)
      draw_odometry_per_pose();
    else if (config_.along_way)
      draw_odometry_along_way();
    else
      draw_odometry_per_increment();
  }

  Eigen::Vector3d odometry_noise(std::size_t stop) const {
    RandomStream random(config_.seed, "geometric odometry", static_cast<std::int64_t>(stop));
    const double sigma_xy = config_.lambda * kPaperTranslationSigma_m, sigma_yaw = config_.lambda * kPaperYawSigma_rad;
    Eigen::Vector3d noise(random.normal(0.0, sigma_xy), random.normal(0.0, sigma_xy), random.normal(0.0, sigma_yaw));
    if (random.uniform() < config_.odometry_outlier_fraction)
      noise += Eigen::Vector3d(random.normal(0.0, 0.2), random.normal(0.0, 0.2), random.normal(0.0, 0.2));
    return noise;
  }

  Eigen::Vector3d planar(std::size_t stop) const {
    const Rigid3& T = scene_.T_world_robot[stop];
    return {T.translation.x(), T.translation.y(), heading(T)};
  }

  // Yaw of T = Rz(yaw) Exp(roll, pitch, 0): the rotation about z that leaves a rotation vector without z part.
  static double heading(const Rigid3& T) { return 2.0 * std::atan2(T.rotation.z(), T.rotation.w()); }

  void push_stop(std::size_t i, const Eigen::Vector3d& pose) {
    Stop stop;
    stop.stamp_s = kStopInterval_s * static_cast<double>(i);
    stop.x_m = pose.x();
    stop.y_m = pose.y();
    stop.yaw_rad = wrap_angle(pose.z());
    run_.observations.stops.push_back(stop);
  }

  void draw_odometry_per_pose() {
    for (std::size_t i = 0; i < scene_.T_world_robot.size(); ++i) push_stop(i, planar(i) + odometry_noise(i));
  }

  void draw_odometry_per_increment() {
    Eigen::Vector3d odometry = planar(0);
    push_stop(0, odometry);
    for (std::size_t i = 1; i < scene_.T_world_robot.size(); ++i) {
      const Eigen::Vector3d from = planar(i - 1), to = planar(i), noise = odometry_noise(i);
      const Eigen::Vector2d step = Eigen::Rotation2Dd(-from.z()) * Eigen::Vector2d(to.head<2>() - from.head<2>());
      const Eigen::Vector2d measured = config_.odometry_scale * step + noise.head<2>();
      odometry.head<2>() += Eigen::Rotation2Dd(odometry.z()) * measured;
      odometry.z() += config_.odometry_yaw_factor * wrap_angle(to.z() - from.z()) + noise.z();
      push_stop(i, odometry);
    }
  }

  // Turn, way, turn in small pieces, each of them measured with its own noise.
  void draw_odometry_along_way() {
    Eigen::Vector3d odometry = planar(0);
    push_stop(0, odometry);
    for (std::size_t i = 1; i < scene_.T_world_robot.size(); ++i) {
      const Eigen::Vector3d from = planar(i - 1), to = planar(i);
      const Eigen::Vector2d step = Eigen::Rotation2Dd(-from.z()) * Eigen::Vector2d(to.head<2>() - from.head<2>());
      const bool backwards = step.x() < 0.0;
      const double first = std::atan2(backwards ? -step.y() : step.y(), std::abs(step.x()));
      const double way = backwards ? -step.norm() : step.norm();
      RandomStream random(config_.seed, "geometric odometry", static_cast<std::int64_t>(i));
      std::vector<Eigen::Vector3d> passed;
      drive_piece(0.0, first, &random, &odometry, &passed);
      drive_piece(way, 0.0, &random, &odometry, &passed);
      drive_piece(0.0, wrap_angle(to.z() - from.z() - first), &random, &odometry, &passed);
      passed.pop_back();  // the stop itself
      push_stop(i, odometry);
      run_.observations.stops.back().way = std::move(passed);
    }
  }

  void drive_piece(double way, double turn, RandomStream* random, Eigen::Vector3d* odometry,
                   std::vector<Eigen::Vector3d>* passed) const {
    constexpr int kSteps = 8;
    constexpr double kTurnOfAMetre_rad = 0.1;
    const double along_m = std::abs(way) / kSteps, turning = std::abs(turn) / kSteps + kTurnOfAMetre_rad * along_m;
    const double sigma_xy = config_.lambda * kPaperTranslationSigma_m * std::sqrt(along_m);
    const double sigma_yaw = config_.lambda * kPaperYawSigma_rad * std::sqrt(turning);
    for (int k = 0; k < kSteps; ++k) {
      const Eigen::Vector2d noise(random->normal(0.0, sigma_xy), random->normal(0.0, sigma_xy));
      const double turned = config_.odometry_yaw_factor * turn / kSteps + random->normal(0.0, sigma_yaw);
      odometry->head<2>() += Eigen::Rotation2Dd(odometry->z() + 0.5 * turned) *
                             Eigen::Vector2d(Eigen::Vector2d(config_.odometry_scale * way / kSteps, 0.0) + noise);
      odometry->z() += turned;
      passed->push_back(*odometry);
    }
  }

  const GeometricConfig& config_;
  GeometricScene scene_;
  GeometricRun run_;
};

}  // namespace

std::optional<RayMoments> ground_ray_moments(const Camera& camera, const Eigen::Vector3d& a) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  int count = 0;
  for (int row = 0; row < kGridRows; ++row) {
    for (int column = 0; column < kGridColumns; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) * camera.width_px / kGridColumns - 0.5,
                                  (row + 0.5) * camera.height_px / kGridRows - 0.5);
      Eigen::Vector3d ray;
      if (!camera.unproject(pixel, &ray)) continue;
      const double inverse_depth = a.dot(ray);
      if (inverse_depth < 1.0 / kMaxGroundDepth_m || inverse_depth > 1.0 / kMinGroundDepth_m) continue;
      sum += ray * ray.transpose();
      ++count;
    }
  }
  if (count < kMinRaysOnGround) return std::nullopt;
  const double pixels = static_cast<double>(camera.width_px) * camera.height_px * count / (kGridColumns * kGridRows);
  return RayMoments{sum / count, pixels};
}

RayMoments board_ray_moments(const Camera& camera, const Board& board, const Rigid3& T_camera_board) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const int columns = 2 * board.squares_x, rows = 2 * board.squares_y;
  for (int i = 0; i < columns * rows; ++i) {
    const int column = i % columns, row = i / columns;
    const double x = board.square_m * inside_board(column, columns, board.squares_x);
    const double y = board.square_m * inside_board(row, rows, board.squares_y);
    const Eigen::Vector3d point = T_camera_board * Eigen::Vector3d(x, y, 0.0);
    const Eigen::Vector3d ray = point / point.z();
    sum += ray * ray.transpose();
  }
  // The quadrangle of the outline.
  double twice_area = 0.0;
  const auto outline = board.outline();
  Eigen::Vector2d from, to;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (!camera.project(T_camera_board * outline[i], &from) ||
        !camera.project(T_camera_board * outline[(i + 1) % outline.size()], &to))
      continue;
    twice_area += from.x() * to.y() - from.y() * to.x();
  }
  return {sum / (columns * rows), std::max(1.0, 0.5 * std::abs(twice_area))};
}

OdometryNoise paper_odometry_noise(OdometryModel model, double lambda) {
  return {model, lambda * kPaperTranslationSigma_m, lambda * kPaperYawSigma_rad};
}

GeometricRun draw_geometric_run(const GeometricConfig& config) {
  check(config);
  return Drawer(config, draw_scene(config)).draw();
}

GeometricRun draw_geometric_run(const GeometricConfig& config, const GeometricScene& scene) {
  check(config);
  return Drawer(config, scene).draw();
}

}  // namespace rigproof
