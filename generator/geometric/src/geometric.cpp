#include "rigproof/geometric/geometric.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>
#include <utility>

#include "rigproof/core/board_markers.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/draw_vector.h"
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

double stamp_of(std::size_t stop) { return kStopInterval_s * static_cast<double>(stop); }

double depth_scale_of(const GeometricConfig& config, std::size_t camera) {
  if (!config.depth_scales.empty()) return config.depth_scales[camera];
  RandomStream random(config.seed, "geometric depth scale", -1, static_cast<std::int32_t>(camera));
  return 1.0 + random.normal(0.0, config.depth_scale_sigma);
}

Truth truth_of(const GeometricConfig& config, const GeometricScene& scene) {
  Truth truth;
  truth.scene = "geometric";
  truth.seed = config.seed;
  truth.board = config.rig.board;
  truth.T_world_board = scene.T_world_board;
  for (const GeometricBoard& board : scene.more_boards)
    truth.more_boards.push_back({board.board, {}, board.T_world_board});
  truth.odometry_noise = paper_odometry_noise(config.odometry_model, config.lambda);
  truth.odometry_scale = config.odometry_scale;
  truth.odometry_yaw_factor = config.odometry_yaw_factor;
  for (std::size_t c = 0; c < config.rig.cameras.size(); ++c) {
    const RigCamera& camera = config.rig.cameras[c];
    truth.cameras.push_back({camera.name, config.rig.T_robot_camera[c], camera.camera, depth_scale_of(config, c), {}});
  }
  for (std::size_t i = 0; i < scene.T_world_robot.size(); ++i)
    truth.stops.push_back({stamp_of(i), scene.T_world_robot[i]});
  return truth;
}

// What a recording's reader is told, before anything is measured.
Observations told_part(const GeometricConfig& config, const GeometricScene& scene, const OdometryNoise& odometry) {
  Observations observations;
  observations.source = "geometric mode, seed " + std::to_string(config.seed);
  observations.board = config.rig.board;
  for (const GeometricBoard& board : scene.more_boards) observations.more_boards.push_back(board.board);
  observations.cameras = config.rig.cameras;
  for (RigCamera& camera : observations.cameras) {
    if (!camera.depth) continue;
    camera.depth->noise.bias_inverse_depth_per_m = camera.depth->noise.bias_m = 0.0;  // none is drawn
    if (config.measured.empty()) camera.depth->noise.inverse_depth_sigma_per_m = config.inverse_depth_sigma_per_m;
    if (config.depth_scales.empty()) camera.depth->noise.scale_sigma = config.depth_scale_sigma;  // what is true
  }
  if (config.declare_odometry_model) observations.odometry_noise.model = config.odometry_model;
  if (config.declare_odometry_sigmas) {
    observations.odometry_noise.sigma_xy_m = odometry.sigma_xy_m;
    observations.odometry_noise.sigma_yaw_rad = odometry.sigma_yaw_rad;
  }
  constexpr double kDrivenAxle_m = 0.005;  // as of a robot that turns about the middle of one
  if (config.along_way) observations.odometry_noise.rotation_centre_sigma_m = kDrivenAxle_m;
  return observations;
}

// ----------------------------------------------------------------------------------------------------------- frames

/// One frame: a camera at a stop.
struct Frame {
  const GeometricConfig& config;
  int stop, camera;
  Rigid3 T_camera_world;
  double depth_scale;

  const RigCamera& rig_camera() const { return config.rig.cameras[static_cast<std::size_t>(camera)]; }
  RandomStream random(const char* purpose) const { return {config.seed, purpose, stop, camera}; }
};

// The configuration's figures for all cameras, or what was measured of this one.
GeometricNoise noise_of(const GeometricConfig& config, int camera) {
  if (!config.measured.empty()) return config.measured[static_cast<std::size_t>(camera)];
  GeometricNoise noise;
  noise.corner_sigma_px = config.corner_sigma_px;
  const double sigma = config.inverse_depth_sigma_per_m;
  if (config.ground) noise.ground_sigma_per_m = sigma;
  if (config.board_planes) noise.board_sigma_per_m = sigma;
  noise.ground_points = config.ground_points;
  noise.board_points = config.board_points;
  return noise;
}

Eigen::Vector3d print_error(const GeometricBoard& board, int id) {
  return board.print_errors_m.empty() ? Eigen::Vector3d::Zero() : board.print_errors_m[static_cast<std::size_t>(id)];
}

// Nothing where the camera does not see the whole front of the board.
std::optional<BoardView> draw_corners(const Frame& frame, const GeometricBoard& seen, double sigma_px) {
  const Board& board = seen.board;
  const Camera& lens = frame.rig_camera().camera;
  const Rigid3 T = frame.T_camera_world * seen.T_world_board;
  if ((T.rotation * Eigen::Vector3d::UnitZ()).dot(T * board.centre()) <= 0.0) return std::nullopt;
  RandomStream random = frame.random("geometric corners");
  BoardView view;
  view.stop = frame.stop;
  view.camera = frame.camera;
  view.stamp_s = kStopInterval_s * frame.stop;
  const double floor_px = 1e-3;  // a covariance must be positive, even where no noise is drawn
  const double stated_px = std::max(sigma_px, floor_px);
  for (int id = 0; id < board.corner_count(); ++id) {
    CornerObservation corner;
    corner.id = id;
    const Eigen::Vector3d printed = board.corner(id) + print_error(seen, id);
    if (!lens.project(T * printed, &corner.pixel) || !lens.contains(corner.pixel)) return std::nullopt;
    corner.pixel += sigma_px * draw_vector<2>([&] { return random.normal(); });
    corner.covariance_px2 = stated_px * stated_px * Eigen::Matrix2d::Identity();
    if (random.uniform() < frame.config.corner_outlier_fraction)
      corner.pixel += draw_vector<2>([&] { return random.uniform(-20.0, 20.0); });
    view.corners.push_back(corner);
  }
  return view;
}

/// A plane n.x = d as a = n / d, and how the rays that meet it lie.
PlaneObservation draw_plane(const Frame& frame, const char* purpose, const Eigen::Vector3d& a,
                            const RayMoments& moments, double sigma, double points) {
  RandomStream random = frame.random(purpose);
  PlaneObservation observation;
  observation.stop = frame.stop;
  observation.camera = frame.camera;
  const double stated = std::max(sigma, 1e-6), effective = points > 0.0 ? points : moments.pixels;
  observation.covariance_per_m2 = stated * stated * (moments.mean * effective).inverse();
  const Eigen::Matrix3d L = observation.covariance_per_m2.llt().matrixL();
  const Eigen::Vector3d noise = draw_vector<3>([&] { return random.normal(); });
  observation.inverse_depth_plane = a / frame.depth_scale + (sigma > 0.0 ? 1.0 : 0.0) * (L * noise);
  if (random.uniform() < frame.config.plane_outlier_fraction) {
    const Eigen::Vector3d tilt = draw_vector<3>([&] { return random.normal(0.0, 0.1); });
    observation.inverse_depth_plane = random.uniform(0.7, 1.4) * (so3_exp(tilt) * observation.inverse_depth_plane);
  }
  observation.effective_points = effective;
  observation.inlier_points = static_cast<int>(effective);
  observation.residual_rms = 1.0;
  return observation;
}

std::optional<PlaneObservation> draw_ground(const Frame& frame, const GeometricNoise& noise) {
  const Eigen::Vector3d up = frame.T_camera_world.rotation * Eigen::Vector3d::UnitZ();
  const double height = -up.dot(frame.T_camera_world.translation);
  const std::optional<RayMoments> moments = ground_ray_moments(frame.rig_camera().camera, -up / height);
  if (!moments) return std::nullopt;
  return draw_plane(frame, "geometric ground", -up / height, *moments, *noise.ground_sigma_per_m, noise.ground_points);
}

PlaneObservation draw_board_plane(const Frame& frame, const GeometricBoard& board, const GeometricNoise& noise) {
  const Rigid3 T_camera_board = frame.T_camera_world * board.T_world_board;
  const Eigen::Vector3d normal = T_camera_board.rotation * Eigen::Vector3d::UnitZ();
  const double distance = normal.dot(T_camera_board.translation);
  const RayMoments moments = board_ray_moments(frame.rig_camera().camera, board.board, T_camera_board);
  return draw_plane(frame, "geometric board plane", normal / distance, moments, *noise.board_sigma_per_m,
                    noise.board_points);
}

// Of the boards that it sees, the one with most corners.
std::optional<BoardView> draw_view(const Frame& frame, const std::vector<GeometricBoard>& boards, double sigma_px) {
  std::optional<BoardView> most;
  for (std::size_t b = 0; b < boards.size(); ++b) {
    std::optional<BoardView> view = draw_corners(frame, boards[b], sigma_px);
    if (!view || (most && view->corners.size() <= most->corners.size())) continue;
    view->board = static_cast<int>(b);
    most = std::move(view);
  }
  return most;
}

void add_frame(const Frame& frame, const std::vector<GeometricBoard>& boards, Observations* observations) {
  const GeometricNoise noise = noise_of(frame.config, frame.camera);
  const std::optional<BoardView> view = draw_view(frame, boards, noise.corner_sigma_px);
  if (view) observations->board_views.push_back(*view);
  if (!frame.rig_camera().depth) return;
  if (noise.ground_sigma_per_m)
    if (const std::optional<PlaneObservation> ground = draw_ground(frame, noise))
      observations->ground_planes.push_back(*ground);
  if (view && noise.board_sigma_per_m)
    observations->board_planes.push_back(draw_board_plane(frame, boards[static_cast<std::size_t>(view->board)], noise));
}

// --------------------------------------------------------------------------------------------------------- odometry

Eigen::Vector3d odometry_noise(const GeometricConfig& config, std::size_t stop) {
  RandomStream random(config.seed, "geometric odometry", static_cast<std::int64_t>(stop));
  const double sigma_xy = config.lambda * kPaperTranslationSigma_m, sigma_yaw = config.lambda * kPaperYawSigma_rad;
  Eigen::Vector3d noise =
      draw_vector<3>([&] { return random.normal(); }).cwiseProduct(Eigen::Vector3d(sigma_xy, sigma_xy, sigma_yaw));
  if (random.uniform() < config.odometry_outlier_fraction)
    noise += draw_vector<3>([&] { return random.normal(0.0, 0.2); });
  return noise;
}

// x, y, and the yaw of T = Rz(yaw) Exp(roll, pitch, 0): the rotation about z that leaves a rotation vector without z
// part.
Eigen::Vector3d planar(const Rigid3& T) {
  return {T.translation.x(), T.translation.y(), 2.0 * std::atan2(T.rotation.z(), T.rotation.w())};
}

Stop stop_at(std::size_t i, const Eigen::Vector3d& pose) {
  Stop stop;
  stop.stamp_s = stamp_of(i);
  stop.x_m = pose.x();
  stop.y_m = pose.y();
  stop.yaw_rad = wrap_angle(pose.z());
  return stop;
}

/// The way from one stop to the next as the robot at the first one sees it.
struct Step {
  Eigen::Vector2d way;
  double turn_rad;  ///< not wrapped
};

Step step_between(const Rigid3& T_world_from, const Rigid3& T_world_to) {
  const Eigen::Vector3d from = planar(T_world_from), to = planar(T_world_to);
  return {Eigen::Rotation2Dd(-from.z()) * Eigen::Vector2d(to.head<2>() - from.head<2>()), to.z() - from.z()};
}

void add_increment(const GeometricConfig& config, const Step& step, const Eigen::Vector3d& noise,
                   Eigen::Vector3d* odometry) {
  const Eigen::Vector2d measured = config.odometry_scale * step.way + noise.head<2>();
  odometry->head<2>() += Eigen::Rotation2Dd(odometry->z()) * measured;
  odometry->z() += config.odometry_yaw_factor * wrap_angle(step.turn_rad) + noise.z();
}

void drive_piece(const GeometricConfig& config, double way, double turn, RandomStream* random,
                 Eigen::Vector3d* odometry, std::vector<Eigen::Vector3d>* passed) {
  constexpr int kSteps = 8;
  const double along_m = std::abs(way) / kSteps, turning = std::abs(turn) / kSteps + config.metre_as_turn_rad * along_m;
  const double sigma_xy = config.lambda * kPaperTranslationSigma_m * std::sqrt(along_m);
  const double sigma_yaw = config.lambda * kPaperYawSigma_rad * std::sqrt(turning);
  for (int k = 0; k < kSteps; ++k) {
    const Eigen::Vector2d noise = draw_vector<2>([&] { return random->normal(0.0, sigma_xy); });
    const double turned = (config.odometry_yaw_factor * turn + config.odometry_veer_rad_per_m * way) / kSteps +
                          random->normal(0.0, sigma_yaw);
    odometry->head<2>() += Eigen::Rotation2Dd(odometry->z() + 0.5 * turned) *
                           Eigen::Vector2d(Eigen::Vector2d(config.odometry_scale * way / kSteps, 0.0) + noise);
    odometry->z() += turned;
    passed->push_back(*odometry);
  }
}

// Turn, way, turn in small pieces, each of them measured with its own noise. Returns the poses passed.
std::vector<Eigen::Vector3d> drive_way(const GeometricConfig& config, const Step& step, std::size_t stop,
                                       Eigen::Vector3d* odometry) {
  const bool backwards = step.way.x() < 0.0;
  const double first = std::atan2(backwards ? -step.way.y() : step.way.y(), std::abs(step.way.x()));
  const double way = backwards ? -step.way.norm() : step.way.norm();
  RandomStream random(config.seed, "geometric odometry", static_cast<std::int64_t>(stop));
  std::vector<Eigen::Vector3d> passed;
  drive_piece(config, 0.0, first, &random, odometry, &passed);
  drive_piece(config, way, 0.0, &random, odometry, &passed);
  drive_piece(config, 0.0, wrap_angle(step.turn_rad - first), &random, odometry, &passed);
  passed.pop_back();  // the stop itself
  return passed;
}

std::vector<Stop> draw_odometry(const GeometricConfig& config, const std::vector<Rigid3>& T_world_robot) {
  std::vector<Stop> stops;
  const bool per_pose = config.odometry_model == OdometryModel::kPerPose;
  for (std::size_t i = 0; i < T_world_robot.size() && per_pose; ++i)
    stops.push_back(stop_at(i, planar(T_world_robot[i]) + odometry_noise(config, i)));
  if (per_pose) return stops;
  Eigen::Vector3d odometry = planar(T_world_robot.front());
  stops.push_back(stop_at(0, odometry));
  for (std::size_t i = 1; i < T_world_robot.size(); ++i) {
    const Step step = step_between(T_world_robot[i - 1], T_world_robot[i]);
    std::vector<Eigen::Vector3d> way;
    if (config.along_way)
      way = drive_way(config, step, i, &odometry);
    else
      add_increment(config, step, odometry_noise(config, i), &odometry);
    stops.push_back(stop_at(i, odometry));
    stops.back().way = std::move(way);
  }
  return stops;
}

GeometricRun draw(const GeometricConfig& config, const GeometricScene& scene) {
  GeometricRun run;
  run.truth = truth_of(config, scene);
  run.observations = told_part(config, scene, run.truth.odometry_noise);
  std::vector<GeometricBoard> boards = {{config.rig.board, scene.T_world_board, config.rig.print_errors_m}};
  boards.insert(boards.end(), scene.more_boards.begin(), scene.more_boards.end());
  for (std::size_t i = 0; i < scene.T_world_robot.size(); ++i) {
    for (std::size_t c = 0; c < config.rig.cameras.size(); ++c) {
      const Rigid3 T_camera_world = (scene.T_world_robot[i] * config.rig.T_robot_camera[c]).inverse();
      const double depth_scale = *run.truth.cameras[c].depth_scale;
      add_frame({config, static_cast<int>(i), static_cast<int>(c), T_camera_world, depth_scale}, boards,
                &run.observations);
    }
  }
  run.observations.stops = draw_odometry(config, scene.T_world_robot);
  return run;
}

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
  const double beyond = board.square_m - first_corner_m(board);  // of an AprilGrid's cells
  for (int i = 0; i < columns * rows; ++i) {
    const int column = i % columns, row = i / columns;
    const double x = beyond + board.square_m * inside_board(column, columns, board.squares_x);
    const double y = beyond + board.square_m * inside_board(row, rows, board.squares_y);
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
  return draw(config, draw_scene(config));
}

GeometricRun draw_geometric_run(const GeometricConfig& config, const GeometricScene& scene) {
  check(config);
  return draw(config, scene);
}

}  // namespace rigproof
