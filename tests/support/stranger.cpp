#include "stranger.h"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "rigproof/calib/estimate/depth_bias.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/draw_vector.h"
#include "rigproof/core/lens_residual.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

// A smooth field over an image of a family that the estimator does not know: waves of half the image's size to one and
// a half, without what a change of the lens or a turn of the camera makes.
class Waves {
 public:
  Waves(const Camera& camera, double rms_px, RandomStream* random) : camera_(camera) {
    for (Eigen::Vector4d& wave : waves_) {
      const double length = std::exp(random->uniform(std::log(0.45), std::log(1.6)));
      const double heading = random->uniform(-kPi, kPi);
      wave << 2.0 * kPi / length * std::cos(heading), 2.0 * kPi / length * std::sin(heading),
          random->uniform(-kPi, kPi), random->uniform(-kPi, kPi);
    }
    constexpr int kAcross = 16, kDown = 9;
    Eigen::MatrixXd modes(2 * kAcross * kDown, 8);
    Eigen::VectorXd field(modes.rows());
    for (int i = 0; i < kAcross * kDown; ++i) {
      const Eigen::Vector2d pixel((i % kAcross + 0.5) / kAcross * camera.width_px,
                                  (i / kAcross + 0.5) / kDown * camera.height_px);
      modes.middleRows<2>(2 * i) = lens_and_turn(pixel);
      field.segment<2>(2 * i) = waves_at(pixel);
    }
    taken_out_ = modes.colPivHouseholderQr().solve(field);
    scale_ = rms_px / std::sqrt((field - modes * taken_out_).squaredNorm() / static_cast<double>(field.size()));
  }
  Eigen::Vector2d at(const Eigen::Vector2d& pixel) const {
    return scale_ * (waves_at(pixel) - lens_and_turn(pixel) * taken_out_);
  }

 private:
  Eigen::Vector2d normalised(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - camera_.cx_px) / camera_.fx_px, (pixel.y() - camera_.cy_px) / camera_.fy_px};
  }
  Eigen::Matrix<double, 2, 8> lens_and_turn(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d n = normalised(pixel);
    const double x = n.x(), y = n.y(), square = n.squaredNorm();
    Eigen::Matrix<double, 2, 8> modes;
    modes << 1, 0, x, x, -y, x * square, 1 + x * x, x * y,  //
        0, 1, y, -y, x, y * square, x * y, 1 + y * y;
    return modes;
  }
  Eigen::Vector2d waves_at(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d place = pixel / camera_.width_px;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Eigen::Vector4d& wave : waves_) {
      const double phase = wave.head<2>().dot(place);
      sum += Eigen::Vector2d(std::sin(phase + wave[2]), std::sin(phase + wave[3]));
    }
    return sum;
  }

  Camera camera_;
  std::array<Eigen::Vector4d, 6> waves_;
  Eigen::VectorXd taken_out_;
  double scale_ = 1.0;
};

// Lenses and depth of the true cameras.
void draw_cameras(const Worse& worse, RandomStream* random, GeometricConfig* config, Stranger* made) {
  RandomStream shifts(config->seed, "shifts of depth images"),
      left(config->seed, "what lenses leave in planes of depth");
  const IntrinsicsSigma sigma;
  const DepthNoise depth;
  const double common_depth = random->normal(0.0, depth.common_scale_sigma);
  for (RigCamera& camera : config->rig.cameras) {
    made->lens.emplace_back();
    made->lens.back() << random->normal(0.0, sigma.focal_relative), random->normal(0.0, sigma.principal_point_px),
        random->normal(0.0, sigma.principal_point_px), random->normal(0.0, sigma.focal_ratio),
        random->normal(0.0, sigma.distortion_px);
    camera.camera = ml::Lenses(camera.camera).changed(made->lens.back());
    camera.depth->noise.scale_sigma = depth.scale_sigma;
    config->depth_scales.push_back(1.0 + common_depth + random->normal(0.0, depth.scale_sigma));
    made->depth.emplace_back(random->normal(0.0, depth.offset_sigma_m), random->normal(0.0, depth.tilt_sigma_rad),
                             random->normal(0.0, depth.tilt_sigma_rad));
    const double shift_sigma = depth.shift_sigma_px / camera.camera.fx_px;
    const double left_sigma = 0.1 * sigma.distortion_px / camera.camera.fx_px;
    made->shape.emplace_back();
    made->shape.back() << draw_vector<2>([&] { return shifts.normal(0.0, shift_sigma); }),
        draw_vector<4>([&] { return left.normal(0.0, left_sigma); });
    if (made->depth.size() == 2) made->depth.back()[0] += worse.depth_offset_m;
  }
}

// Size, ratio and bow of the true board, and where print puts its corners.
void draw_board(const Worse& worse, RandomStream* random, Board* board, Stranger* made) {
  board->doubt();
  const double side = board->square_sigma_relative();
  made->board << random->normal(0.0, side), random->normal(0.0, 0.2 * side), random->normal(0.0, board->bow_sigma()),
      random->normal(0.0, board->bow_sigma());
  for (int corner = 0; corner < board->corner_count(); ++corner) {
    made->print.emplace_back();
    for (int axis = 0; axis < 3; ++axis)
      made->print.back()[axis] = random->normal(0.0, worse.print * board->print_sigma());
  }
}

// What no distortion model follows, of each camera.
std::vector<Stranger::Field> draw_fields(const GeometricConfig& config, const Worse& worse, RandomStream* random) {
  std::vector<Stranger::Field> fields;
  for (const RigCamera& camera : config.rig.cameras) {
    const double rms_px = IntrinsicsSigma().residual_px * (fields.size() == 1 ? worse.field : 1.0);
    if (worse.cells > 0.0) {
      const std::string purpose = "field " + std::to_string(fields.size());
      fields.emplace_back(
          [field = draw_lens_residual(camera.camera, rms_px, worse.cells, RandomStream(config.seed, purpose))](
              const Eigen::Vector2d& pixel) { return field.at(pixel); });
    } else {
      fields.emplace_back(
          [field = Waves(camera.camera, rms_px, random)](const Eigen::Vector2d& pixel) { return field.at(pixel); });
    }
  }
  return fields;
}

// Registered depth sees through the stated lens: what it shows of a plane errs with it.
void bend_planes(const Stranger& made, std::size_t camera, const Camera& told, std::vector<PlaneObservation>* planes) {
  for (PlaneObservation& plane : *planes) {
    if (plane.camera != static_cast<int>(camera)) continue;
    plane.file = "depth/000000.png";
    plane.inverse_depth_plane -=
        ml::Lenses(told).plane_by(plane.inverse_depth_plane) * made.lens[camera] +
        plane_by_depth_offset(plane.inverse_depth_plane, mean_inverse_depth(plane)) * made.depth[camera] +
        plane_by_depth_shape(plane.inverse_depth_plane) * made.shape[camera];
  }
}

}  // namespace

Worse of_any_scale(int seed) {
  Worse drawn;
  RandomStream random(static_cast<std::uint64_t>(seed), "scale of the lenses' fields");
  if (seed % 3 != 0) drawn.cells = 8.0 * std::exp2(random.uniform());
  return drawn;
}

std::vector<Eigen::Vector3d> print_errors_m(const Board& board, const Eigen::Vector4d& shape,
                                            const std::vector<Eigen::Vector3d>& print) {
  std::vector<Eigen::Vector3d> errors;
  for (const Eigen::Vector3d& corner : board.corners()) {
    const Eigen::Vector3d p = corner - board.centre();
    const double u = 2.0 * p.x() / (board.square_m * board.squares_x),
                 v = 2.0 * p.y() / (board.square_m * board.squares_y);
    errors.emplace_back((shape[0] + 0.5 * shape[1]) * p.x(), (shape[0] - 0.5 * shape[1]) * p.y(),
                        shape[2] * u * u + shape[3] * v * v);
    errors.back() += print[errors.size() - 1];
  }
  return errors;
}

Stranger draw_stranger(int seed, double corner_sigma_px, const Worse& worse) {
  Stranger made;
  GeometricConfig& config = made.config;
  config.corner_sigma_px = corner_sigma_px;
  config.seed = static_cast<std::uint64_t>(seed);
  config.board_planes = true;
  made.told = config.rig;
  RandomStream random(config.seed, "strangers");
  draw_cameras(worse, &random, &config, &made);
  draw_board(worse, &random, &config.rig.board, &made);
  config.rig.print_errors_m = print_errors_m(config.rig.board, made.board, made.print);
  made.fields = draw_fields(config, worse, &random);
  return made;
}

Observations as_told(const Stranger& robot, Observations observations) {
  observations.board = robot.config.rig.board;
  for (BoardView& view : observations.board_views)
    for (CornerObservation& corner : view.corners)
      corner.pixel += robot.fields[static_cast<std::size_t>(view.camera)](corner.pixel);
  for (std::size_t c = 0; c < observations.cameras.size(); ++c) {
    observations.cameras[c].camera = robot.told.cameras[c].camera;
    observations.cameras[c].intrinsics_sigma = IntrinsicsSigma();
    observations.cameras[c].depth->noise = robot.config.rig.cameras[c].depth->noise;
    observations.cameras[c].depth->noise.doubt_place_and_common_scale();
    bend_planes(robot, c, robot.told.cameras[c].camera, &observations.ground_planes);
    bend_planes(robot, c, robot.told.cameras[c].camera, &observations.board_planes);
  }
  return observations;
}

GeometricRun drive(const Stranger& robot, std::uint64_t seed, int stops) {
  GeometricConfig config = robot.config;
  config.seed = seed;
  config.stops = stops;
  GeometricRun run = draw_geometric_run(config);
  run.observations = as_told(robot, std::move(run.observations));
  return run;
}

}  // namespace rigproof
