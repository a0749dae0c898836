#include "priors_robots.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/calib/estimate/unknowns.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/draw_vector.h"
#include "rigproof/core/random.h"
#include "stranger.h"

namespace rigproof::bench {
namespace {

constexpr double kCorner_px = 0.1;
// Slack of tyres: no prior is stated, as its size is found.
constexpr double kSuspension_m = 0.0005, kSuspension_rad = 0.02 * kPi / 180.0;
// As its rig states it: with the 50 mm of one that states nothing, most answers would be too uncertain to be given.
constexpr double kTurningPoint_m = 0.01;

class Drawing {
 public:
  Drawing(std::uint64_t drive, const Seeds& seeds, int stops) : seeds_(seeds) {
    robot_ = of("lens");
    robot_.config.depth_scales = of("depth scale").config.depth_scales;
    const Stranger depth = of("depth error"), print = of("print and lens residual");
    robot_.depth = depth.depth;
    robot_.shape = depth.shape;
    robot_.board = of("board").board;
    robot_.print = print.print;
    robot_.fields = print.fields;
    GeometricConfig& config = robot_.config;
    config.rig.print_errors_m = print_errors_m(config.rig.board, robot_.board, robot_.print);
    config.stops = stops;
    config.along_way = true;
    config.declare_odometry_model = config.declare_odometry_sigmas = false;
    draw_odometry_factors();
    GeometricConfig as_told = config;  // which lens it is moves no stop
    as_told.rig = robot_.told;
    as_told.seed = drive;
    scene_ = draw_scene(as_told);
    lean();
  }

  DrawnRobot made() {
    GeometricRun made = run("corners");
    made.observations.ground_planes = run("ground depth").observations.ground_planes;
    made.observations.board_planes = run("board depth").observations.board_planes;
    made.observations.stops = run("odometry").observations.stops;
    made.observations.odometry_noise.rotation_centre_sigma_m = kTurningPoint_m;
    turn_elsewhere(&made.observations.stops);
    return {as_told(robot_, std::move(made.observations)), std::move(made.truth)};
  }

 private:
  std::uint64_t seed(const std::string& source) const {
    for (std::size_t i = 0; i < kSources.size(); ++i)
      if (source == kSources[i]) return seeds_[i];
    return 0;
  }
  Stranger of(const std::string& source) const {
    const auto number = static_cast<int>(seed(source));
    return draw_stranger(number, kCorner_px, of_any_scale(number));
  }
  GeometricRun run(const std::string& source) const {
    GeometricConfig config = robot_.config;
    config.seed = seed(source);
    return draw_geometric_run(config, scene_);
  }

  void draw_odometry_factors() {
    RandomStream random(seed("odometry"), "factors of the odometry");
    const PriorSigmas priors = usual_priors();
    robot_.config.odometry_scale = random.normal(1.0, priors.odometry_scale);
    robot_.config.odometry_yaw_factor = random.normal(1.0, priors.odometry_yaw_factor);
    robot_.config.odometry_veer_rad_per_m = random.normal(0.0, priors.odometry_veer_rad_per_m);
  }
  void lean() {
    RandomStream random(seed("suspension"), "suspension");
    for (Rigid3& T_world_robot : scene_.T_world_robot) {
      const Eigen::Vector3d lean = draw_vector<3>([&] { return random.normal(); });
      T_world_robot = T_world_robot * Rigid3(so3_exp({kSuspension_rad * lean.x(), kSuspension_rad * lean.y(), 0.0}),
                                             Eigen::Vector3d(0.0, 0.0, kSuspension_m * lean.z()));
    }
  }
  // What was integrated is the way of the point about which the robot turns.
  void turn_elsewhere(std::vector<Stop>* stops) const {
    RandomStream random(seed("turning point"), "turning point");
    const Eigen::Vector2d point_m = draw_vector<2>([&] { return random.normal(0.0, kTurningPoint_m); });
    for (Stop& stop : *stops) {
      const Eigen::Vector3d pose = odometry_of_point({stop.x_m, stop.y_m, stop.yaw_rad}, point_m);
      stop.x_m = pose.x();
      stop.y_m = pose.y();
      for (Eigen::Vector3d& passed : stop.way) passed = odometry_of_point(passed, point_m);
    }
  }

  Seeds seeds_;
  Stranger robot_;
  GeometricScene scene_;
};

}  // namespace

DrawnRobot draw_robot(std::uint64_t drive, const Seeds& seeds, int stops) {
  return Drawing(drive, seeds, stops).made();
}

void widen_priors(double factor, Observations* observations) {
  *observations->odometry_noise.rotation_centre_sigma_m *= factor;
  Board& board = observations->board;
  board.square_sigma_m = factor * board.square_sigma_relative() * board.square_m;
  board.bow_sigma_m = factor * board.bow_sigma();
  board.print_sigma_m = factor * board.print_sigma();
  for (RigCamera& camera : observations->cameras) {
    IntrinsicsSigma& lens = camera.intrinsics_sigma;
    DepthNoise& depth = camera.depth->noise;
    for (double* sigma : {&lens.focal_relative, &lens.focal_ratio, &lens.principal_point_px, &lens.distortion_px,
                          &lens.residual_px, &depth.scale_sigma, &depth.common_scale_sigma, &depth.offset_sigma_m,
                          &depth.tilt_sigma_rad, &depth.shift_sigma_px})
      *sigma *= factor;
  }
}

}  // namespace rigproof::bench
