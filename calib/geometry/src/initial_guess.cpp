#include "rigproof/calib/geometry/initial_guess.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rigproof/core/conventions.h"
#include "rigproof/core/median.h"

namespace rigproof {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Weights of the closed form only; the methods that follow have noise models of their own.
constexpr double kOdometrySigma_m = 0.005;
constexpr double kOdometrySigma_rad = 0.01;
constexpr double kViewFloor_m = 5e-4;
// Cameras stay within a few metres of the robot: decides where the data leave a translation open.
constexpr double kMountingSigma_m = 3.0;
// Below this length (cos psi, sin psi) is noise: the motion does not tell the yaw.
constexpr double kMinDirection = 0.3;

Matrix2d rotation2(double angle_rad) {
  Matrix2d R;
  R << std::cos(angle_rad), -std::sin(angle_rad), std::sin(angle_rad), std::cos(angle_rad);
  return R;
}

// A quarter turn: dR/dangle = S R.
Vector2d quarter_turn(const Vector2d& v) { return {-v.y(), v.x()}; }

// One view, levelled: the camera over the plane through the board's origin.
struct LevelView {
  int stop, camera;
  double heading;     // of the levelled camera in the levelled board frame
  Vector2d position;  // in the levelled board frame
  double height;
  double variance;  // of the position
  double weight;
};

// From view k to view l: same stop, or later.
struct Link {
  const LevelView* from;
  const LevelView* to;
  Vector2d driven = Vector2d::Zero();  // odometry, in the robot's frame at `from`
  double turned = 0.0;                 // odometry
  int steps = 0;                       // stops in between; 0 at one stop
  double weight = 1.0;
};

double heading_of(const Matrix3d& R) {
  // The rotation about z that is nearest to R, level or not.
  return std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
}

class ClosedForm {
 public:
  ClosedForm(const Observations& observations, const std::vector<ViewPose>& views, const TrajectoryAlignment& alignment,
             const GroundCheck& ground)
      : observations_(observations),
        views_(views),
        alignment_(alignment),
        ground_(ground),
        odometry_(odometry_poses(observations)),
        cameras_(observations.cameras.size()) {}

  InitialGuess solve() {
    InitialGuess guess;
    guess.T_robot_camera.resize(cameras_);
    guess.T_world_robot = odometry_;
    level_views();
    if (level_.empty()) return guess;
    make_links();
    relate_yaws();
    solve_translations();
    solve_heights();
    for (std::size_t k = 0; k < cameras_; ++k)
      if (seen_[k]) guess.T_robot_camera[k] = camera_pose(k);
    place_board(&guess);
    place_robot(&guess);
    return guess;
  }

 private:
  void level_views() {
    R_level_board_ = levelling(alignment_.up_board);
    R_level_camera_.assign(cameras_, Matrix3d::Identity());
    seen_.assign(cameras_, false);
    for (std::size_t k = 0; k < cameras_; ++k)
      if (alignment_.up_camera[k]) R_level_camera_[k] = levelling(*alignment_.up_camera[k]);
    // Without any vertical the cameras are levelled by the first view, so that they agree with each other.
    if (alignment_.source == VerticalSource::kNone) level_by_first_views();
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const ViewPose& view = views_[i];
      const std::size_t k = static_cast<std::size_t>(view.camera);
      const Rigid3 T_board_camera = view.T_camera_board.inverse();
      const Vector3d position = R_level_board_ * T_board_camera.translation;
      const Matrix3d R = R_level_board_ * T_board_camera.rotation_matrix() * R_level_camera_[k].transpose();
      const double variance = camera_position_covariance(view).trace() / 3.0 + kViewFloor_m * kViewFloor_m;
      level_.push_back({view.stop, view.camera, heading_of(R), position.head<2>(), position.z(), variance,
                        std::max(alignment_.view_weights[i], 1e-6)});
      seen_[k] = true;
    }
  }

  void level_by_first_views() {
    std::vector<bool> done(cameras_, false);
    for (const ViewPose& view : views_) {
      const std::size_t k = static_cast<std::size_t>(view.camera);
      if (done[k]) continue;
      done[k] = true;
      R_level_camera_[k] = levelling(view.T_camera_board.rotation * alignment_.up_board);
    }
  }

  void make_links() {
    for (std::size_t i = 1; i < level_.size(); ++i) {
      const LevelView& view = level_[i];
      // To the previous view, whatever its camera: this chain connects all cameras.
      add_link(level_[i - 1], view);
      // And to the same camera's previous view, if that is another one.
      for (std::size_t j = i - 1; j-- > 0;) {
        if (level_[j].camera != view.camera) continue;
        if (level_[i - 1].camera != view.camera) add_link(level_[j], view);
        break;
      }
    }
  }

  void add_link(const LevelView& from, const LevelView& to) {
    const Rigid3 motion =
        odometry_[static_cast<std::size_t>(from.stop)].inverse() * odometry_[static_cast<std::size_t>(to.stop)];
    links_.push_back({&from, &to, motion.translation.head<2>(), yaw_of(motion), to.stop - from.stop, 1.0});
  }

  // psi_l - psi_k between two cameras; certainty 0 if no link joins them.
  struct YawDifference {
    double angle = 0.0, certainty = 0.0;
  };

  // psi_k - psi_first of every camera, along the most certain differences.
  void relate_yaws() {
    std::vector<std::vector<YawDifference>> differences(cameras_, std::vector<YawDifference>(cameras_));
    for (std::size_t k = 0; k < cameras_; ++k) {
      for (std::size_t l = k + 1; l < cameras_; ++l) {
        differences[k][l] = yaw_difference(static_cast<int>(k), static_cast<int>(l));
        differences[l][k] = {-differences[k][l].angle, differences[k][l].certainty};
      }
    }
    yaw_.assign(cameras_, 0.0);
    std::vector<bool> known(cameras_, false);
    known[static_cast<std::size_t>(level_.front().camera)] = true;
    for (std::size_t round = 1; round < cameras_; ++round) extend_yaws(differences, &known);
  }

  void extend_yaws(const std::vector<std::vector<YawDifference>>& differences, std::vector<bool>* known) {
    double best = 0.0, best_yaw = 0.0;
    std::size_t best_camera = 0;
    for (std::size_t k = 0; k < cameras_; ++k) {
      for (std::size_t l = 0; l < cameras_; ++l) {
        if (!(*known)[k] || (*known)[l] || differences[k][l].certainty <= best) continue;
        best = differences[k][l].certainty;
        best_camera = l;
        best_yaw = yaw_[k] + differences[k][l].angle;
      }
    }
    if (best <= 0.0) return;
    yaw_[best_camera] = best_yaw;
    (*known)[best_camera] = true;
  }

  // psi_l - psi_k = (heading_l - heading_k) - turn of the odometry: a robust mean on the circle.
  YawDifference yaw_difference(int k, int l) const {
    std::vector<std::pair<double, double>> samples;  // angle, information
    for (const Link& link : links_) {
      const bool forward = link.from->camera == k && link.to->camera == l;
      if (!forward && !(link.from->camera == l && link.to->camera == k)) continue;
      const double angle = wrap_angle(link.to->heading - link.from->heading - link.turned);
      const double variance = 1e-6 + kOdometrySigma_rad * kOdometrySigma_rad * link.steps;
      samples.emplace_back(forward ? angle : -angle, link.from->weight * link.to->weight / variance);
    }
    YawDifference result;
    double softness = kPi;
    for (int round = 0; round < 10 && !samples.empty(); ++round) {
      Vector2d sum = Vector2d::Zero();
      for (const auto& [angle, information] : samples) {
        const double off = round == 0 ? 0.0 : wrap_angle(angle - result.angle) / softness;
        sum += information / (1.0 + off * off) * Vector2d(std::cos(angle), std::sin(angle));
      }
      result = {std::atan2(sum.y(), sum.x()), sum.norm()};
      softness = std::max(0.02, 0.5 * softness);
    }
    return result;
  }

  // The cameras' own measure of how the robot turned along a link.
  double turn(const Link& link) const {
    return (link.to->heading - yaw_[static_cast<std::size_t>(link.to->camera)]) -
           (link.from->heading - yaw_[static_cast<std::size_t>(link.from->camera)]);
  }

  // Displacement of the camera positions along a link, in the robot's frame at `from` but for the yaw psi_0.
  Vector2d displacement(const Link& link) const {
    const double heading = link.from->heading - yaw_[static_cast<std::size_t>(link.from->camera)];
    return rotation2(-heading) * (link.to->position - link.from->position);
  }

  double variance_of(const Link& link) const {
    return link.from->variance + link.to->variance + kOdometrySigma_m * kOdometrySigma_m * link.steps;
  }

  // Least squares for (t_1 .. t_K, cos psi, sin psi), or for the t alone where psi is given.
  // a = R(psi) B + t_k - R(turn) t_l
  VectorXd solve_linear(const std::optional<double>& psi) const {
    const Eigen::Index translations = 2 * static_cast<Eigen::Index>(cameras_), unknowns = translations + (psi ? 0 : 2);
    MatrixXd H = MatrixXd::Zero(unknowns, unknowns);
    VectorXd g = VectorXd::Zero(unknowns);
    H.diagonal().head(translations).setConstant(1.0 / (kMountingSigma_m * kMountingSigma_m));
    for (const Link& link : links_) {
      const Vector2d B = displacement(link);
      Matrix2d by_yaw;
      by_yaw << B, quarter_turn(B);
      const std::array<Matrix2d, 3> J = {Matrix2d::Identity(), -rotation2(turn(link)), by_yaw};
      const std::array<Eigen::Index, 3> place = {2 * link.from->camera, 2 * link.to->camera, translations};
      const Vector2d target = psi ? Vector2d(link.driven - rotation2(*psi) * B) : link.driven;
      const double weight = link.weight * link.from->weight * link.to->weight / variance_of(link);
      for (std::size_t a = 0; a < (psi ? 2U : 3U); ++a) {
        const Matrix2d weighted = weight * J[a].transpose();
        for (std::size_t b = 0; b < (psi ? 2U : 3U); ++b) H.block<2, 2>(place[a], place[b]) += weighted * J[b];
        g.segment<2>(place[a]) += weighted * target;
      }
    }
    // The yaw may be open too; a weight this small decides only then.
    if (!psi) H.diagonal().tail<2>().array() += 1e-6;
    return H.ldlt().solve(g);
  }

  Vector2d residual(const Link& link, const VectorXd& t, double psi) const {
    const Vector2d t_from = t.segment<2>(2 * link.from->camera), t_to = t.segment<2>(2 * link.to->camera);
    return rotation2(psi) * displacement(link) + t_from - rotation2(turn(link)) * t_to - link.driven;
  }

  void solve_translations() {
    // The first rounds are soft, so that a wheel that slipped cannot capture the start.
    double softness_m = 1.0;
    for (int round = 0; round < 8; ++round) {
      const VectorXd solution = solve_linear(std::nullopt);
      const Vector2d direction = solution.tail<2>();
      psi_ = direction.norm() < kMinDirection ? 0.0 : std::atan2(direction.y(), direction.x());
      t_ = solve_linear(psi_);
      for (Link& link : links_) {
        const double off = residual(link, t_, psi_).norm() / softness_m;
        link.weight = 1.0 / (1.0 + off * off);
      }
      softness_m = std::max(0.03, 0.5 * softness_m);
    }
  }

  // z of camera k = mean height over the board's origin + one constant, from the ground or by choice.
  void solve_heights() {
    mean_height_.assign(cameras_, 0.0);
    std::vector<double> sums(cameras_, 0.0);
    for (const LevelView& view : level_) {
      const std::size_t k = static_cast<std::size_t>(view.camera);
      mean_height_[k] += view.weight * view.height;
      sums[k] += view.weight;
    }
    double lowest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < cameras_; ++k) {
      if (sums[k] <= 0.0) continue;
      mean_height_[k] /= sums[k];
      lowest = std::min(lowest, mean_height_[k]);
    }
    board_height_ = ground_offset().value_or(-lowest);
  }

  // Heights over the accepted planes of one camera, less `base_m`.
  void collect_heights(int camera, double base_m, std::vector<double>* heights) const {
    for (std::size_t i = 0; i < observations_.ground_planes.size(); ++i)
      if (ground_.accepted[i] && observations_.ground_planes[i].camera == camera)
        heights->push_back(height_above(observations_.ground_planes[i]).height_m - base_m);
  }

  // Height of the board's origin over the ground, from all cameras.
  std::optional<double> ground_offset() const {
    std::vector<double> offsets;
    for (std::size_t k = 0; k < cameras_; ++k)
      if (seen_[k]) collect_heights(static_cast<int>(k), mean_height_[k], &offsets);
    return offsets.empty() ? std::nullopt : std::optional(median(offsets));
  }

  // A camera's own planes know its height best.
  double camera_height(std::size_t k) const {
    std::vector<double> heights;
    collect_heights(static_cast<int>(k), 0.0, &heights);
    return heights.empty() ? mean_height_[k] + board_height_ : median(heights);
  }

  Rigid3 camera_pose(std::size_t k) const {
    const double yaw = psi_ + yaw_[k];
    const Eigen::Quaterniond R(rotation_z(yaw).toRotationMatrix() * R_level_camera_[k]);
    const Vector2d t = t_.segment<2>(2 * static_cast<Eigen::Index>(k));
    return Rigid3(R, Vector3d(t.x(), t.y(), camera_height(k)));
  }

  // Heading and position of the robot in the levelled board frame, through the camera of a view.
  double robot_heading(const LevelView& view) const {
    return view.heading - psi_ - yaw_[static_cast<std::size_t>(view.camera)];
  }
  Vector2d robot_position(const LevelView& view) const {
    return view.position - rotation2(robot_heading(view)) * t_.segment<2>(2 * view.camera);
  }

  static double certainty(const LevelView& view) { return view.weight / view.variance; }

  // The first view that is no outlier, or the most certain one of its stop.
  const LevelView& anchor_view() const {
    const auto good = std::find_if(level_.begin(), level_.end(), [](const LevelView& v) { return v.weight >= 0.5; });
    const LevelView* anchor = good == level_.end() ? &level_.front() : &*good;
    for (const LevelView& view : level_)
      if (view.stop == anchor->stop && certainty(view) > certainty(*anchor)) anchor = &view;
    return *anchor;
  }

  void place_board(InitialGuess* guess) {
    // One view ties the board to the odometry, and so to the world.
    const LevelView& anchor = anchor_view();
    const Rigid3& robot = odometry_[static_cast<std::size_t>(anchor.stop)];
    board_yaw_ = yaw_of(robot) - robot_heading(anchor);
    board_position_ = robot.translation.head<2>() - rotation2(board_yaw_) * robot_position(anchor);
    guess->T_world_board = Rigid3(Eigen::Quaterniond(rotation_z(board_yaw_).toRotationMatrix() * R_level_board_),
                                  Vector3d(board_position_.x(), board_position_.y(), board_height_));
  }

  void place_robot(InitialGuess* guess) {
    std::vector<const LevelView*> by_stop(odometry_.size(), nullptr);
    for (const LevelView& view : level_) {
      const LevelView*& best = by_stop[static_cast<std::size_t>(view.stop)];
      if (view.weight >= kLeastPlanarWeight && (best == nullptr || certainty(view) > certainty(*best))) best = &view;
    }
    std::vector<bool> placed(odometry_.size(), false);
    for (std::size_t i = 0; i < odometry_.size(); ++i) {
      if (by_stop[i] == nullptr) continue;
      const Vector2d p = board_position_ + rotation2(board_yaw_) * robot_position(*by_stop[i]);
      guess->T_world_robot[i] = planar_pose(p.x(), p.y(), wrap_angle(board_yaw_ + robot_heading(*by_stop[i])));
      placed[i] = true;
    }
    continue_by_odometry(placed, guess);
  }

  // Stops without a view follow from the nearest earlier one that has one, or from the next later one.
  void continue_by_odometry(std::vector<bool> placed, InitialGuess* guess) const {
    std::vector<Rigid3>& poses = guess->T_world_robot;
    for (std::size_t i = 1; i < poses.size(); ++i) {
      if (placed[i] || !placed[i - 1]) continue;
      poses[i] = poses[i - 1] * odometry_[i - 1].inverse() * odometry_[i];
      placed[i] = true;
    }
    for (std::size_t i = poses.size(); i-- > 1;) {
      if (placed[i - 1] || !placed[i]) continue;
      poses[i - 1] = poses[i] * odometry_[i].inverse() * odometry_[i - 1];
      placed[i - 1] = true;
    }
  }

  const Observations& observations_;
  const std::vector<ViewPose>& views_;
  const TrajectoryAlignment& alignment_;
  const GroundCheck& ground_;
  const std::vector<Rigid3> odometry_;
  const std::size_t cameras_;

  Matrix3d R_level_board_ = Matrix3d::Identity();
  std::vector<Matrix3d> R_level_camera_;
  std::vector<bool> seen_;
  std::vector<LevelView> level_;
  std::vector<Link> links_;
  std::vector<double> yaw_;  // psi_k - psi_first
  double psi_ = 0.0;         // psi_first
  VectorXd t_;
  std::vector<double> mean_height_;
  double board_height_ = 0.0;
  double board_yaw_ = 0.0;
  Vector2d board_position_ = Vector2d::Zero();
};

}  // namespace

InitialGuess initial_guess(const Observations& observations, const std::vector<ViewPose>& views,
                           const TrajectoryAlignment& alignment, const GroundCheck& ground) {
  return ClosedForm(observations, views, alignment, ground).solve();
}

}  // namespace rigproof
