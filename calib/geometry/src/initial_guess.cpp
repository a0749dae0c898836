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

Matrix2d rotation2(double angle_rad) { return Eigen::Rotation2Dd(angle_rad).toRotationMatrix(); }

// A quarter turn: dR/dangle = S R.
Vector2d quarter_turn(const Vector2d& v) { return {-v.y(), v.x()}; }

// One view, levelled: the camera over the plane through the board's origin.
struct LevelView {
  int stop, camera;
  double heading;     // of the levelled camera in the levelled board frame
  Vector2d position;  // in the levelled board frame
  double height;
  double variance;          // of the position
  double heading_variance;  // a small board far away is seen turned by degrees
  double weight;
  int board;
};
using LevelViews = std::vector<LevelView>;

// From view k to view l: same stop, or later.
struct Link {
  const LevelView* from;
  const LevelView* to;
  Vector2d driven = Vector2d::Zero();  // odometry, in the robot's frame at `from`
  double turned = 0.0;                 // odometry
  int steps = 0;                       // stops in between; 0 at one stop
};

double heading_of(const Matrix3d& R) {
  // The rotation about z that is nearest to R, level or not.
  return std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
}

// Without any vertical the cameras are levelled by the first view, so that they agree with each other.
std::vector<Matrix3d> camera_levelling(std::size_t cameras, const std::vector<ViewPose>& views,
                                       const TrajectoryAlignment& alignment) {
  std::vector<Matrix3d> R_level_camera(cameras, Matrix3d::Identity());
  for (std::size_t k = 0; k < cameras; ++k)
    if (alignment.up_camera[k]) R_level_camera[k] = levelling(*alignment.up_camera[k]);
  for (auto view = views.rbegin(); view != views.rend(); ++view) {
    const auto k = static_cast<std::size_t>(view->camera), b = static_cast<std::size_t>(view->board);
    if (alignment.source == VerticalSource::kNone || !alignment.up_camera[k])
      R_level_camera[k] = levelling(view->T_camera_board.rotation * alignment.up_board[b]);
  }
  return R_level_camera;
}

// Of each board.
std::vector<LevelViews> level_views(const std::vector<ViewPose>& views, const std::vector<double>& weights,
                                    const std::vector<Matrix3d>& R_level_board,
                                    const std::vector<Matrix3d>& R_level_camera) {
  std::vector<LevelViews> level(R_level_board.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const ViewPose& view = views[i];
    const Matrix3d& R_level = R_level_board[static_cast<std::size_t>(view.board)];
    const Rigid3 T_board_camera = view.T_camera_board.inverse();
    const Vector3d position = R_level * T_board_camera.translation;
    const Matrix3d R =
        R_level * T_board_camera.rotation_matrix() * R_level_camera[static_cast<std::size_t>(view.camera)].transpose();
    const double variance = camera_position_covariance(view).trace() / 3.0 + kViewFloor_m * kViewFloor_m;
    const double heading_variance = view.covariance.bottomRightCorner<3, 3>().trace() / 3.0;
    level[static_cast<std::size_t>(view.board)].push_back({view.stop, view.camera, heading_of(R), position.head<2>(),
                                                           position.z(), variance, heading_variance,
                                                           std::max(weights[i], 1e-6), view.board});
  }
  return level;
}

Link link_between(const LevelView& from, const LevelView& to, const std::vector<Rigid3>& odometry) {
  const Rigid3 motion =
      odometry[static_cast<std::size_t>(from.stop)].inverse() * odometry[static_cast<std::size_t>(to.stop)];
  return {&from, &to, motion.translation.head<2>(), yaw_of(motion), to.stop - from.stop};
}

// To the previous view, whatever its camera, and to the previous view of every camera at an earlier stop: one wrong
// view has then no more links to the other cameras than each right one.
std::vector<Link> make_links(const LevelViews& views, const std::vector<Rigid3>& odometry, std::size_t cameras) {
  std::vector<Link> links;
  std::vector<const LevelView*> last(cameras, nullptr);
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const LevelView* earlier : last)
      if (earlier != nullptr && (earlier == &views[i] - 1 || earlier->stop < views[i].stop))
        links.push_back(link_between(*earlier, views[i], odometry));
    last[static_cast<std::size_t>(views[i].camera)] = &views[i];
  }
  return links;
}

// psi_l - psi_k between two cameras; certainty 0 if no link joins them.
struct YawDifference {
  double angle = 0.0, certainty = 0.0;
};

// psi_l - psi_k = (heading_l - heading_k) - turn of the odometry: a robust mean on the circle. At first every link has
// one vote, however certain it is: of the links of a wrong view, too, some are short.
YawDifference yaw_difference(int k, int l, const std::vector<Link>& links) {
  struct Sample {
    double angle, variance, weight;
  };
  std::vector<Sample> samples;
  for (const Link& link : links) {
    const bool forward = link.from->camera == k && link.to->camera == l;
    if (!forward && !(link.from->camera == l && link.to->camera == k)) continue;
    const double angle = wrap_angle(link.to->heading - link.from->heading - link.turned);
    const double variance = 1e-6 + kOdometrySigma_rad * kOdometrySigma_rad * link.steps + link.from->heading_variance +
                            link.to->heading_variance;
    samples.push_back({forward ? angle : -angle, variance, link.from->weight * link.to->weight});
  }
  YawDifference result;
  double softness = kPi;
  constexpr int kVoting = 8;
  for (int round = 0; round < 10 && !samples.empty(); ++round) {
    Vector2d sum = Vector2d::Zero();
    for (const Sample& sample : samples) {
      const double off = round == 0 ? 0.0 : wrap_angle(sample.angle - result.angle) / softness;
      const double information = sample.weight / (sample.variance + (round < kVoting ? softness * softness : 0.0));
      sum += information / (1.0 + off * off) * Vector2d(std::cos(sample.angle), std::sin(sample.angle));
    }
    result = {std::atan2(sum.y(), sum.x()), sum.norm()};
    softness = std::max(0.02, 0.5 * softness);
  }
  return result;
}

// psi_k - psi_first of every camera, along the most certain differences.
std::vector<double> relate_yaws(std::size_t cameras, std::size_t first, const std::vector<Link>& links) {
  std::vector<std::vector<YawDifference>> differences(cameras, std::vector<YawDifference>(cameras));
  for (std::size_t k = 0; k < cameras; ++k) {
    for (std::size_t l = k + 1; l < cameras; ++l) {
      differences[k][l] = yaw_difference(static_cast<int>(k), static_cast<int>(l), links);
      differences[l][k] = {-differences[k][l].angle, differences[k][l].certainty};
    }
  }
  std::vector<double> yaw(cameras, 0.0);
  std::vector<bool> known(cameras, false);
  known[first] = true;
  for (std::size_t round = 1; round < cameras; ++round) {
    double best = 0.0, best_yaw = 0.0;
    std::size_t best_camera = 0;
    for (std::size_t k = 0; k < cameras; ++k) {
      for (std::size_t l = 0; l < cameras; ++l) {
        if (!known[k] || known[l] || differences[k][l].certainty <= best) continue;
        best = differences[k][l].certainty;
        best_camera = l;
        best_yaw = yaw[k] + differences[k][l].angle;
      }
    }
    if (best <= 0.0) break;
    yaw[best_camera] = best_yaw;
    known[best_camera] = true;
  }
  return yaw;
}

// a = R(psi) B + t_k - R(turn) t_l
struct Equation {
  const Link& link;
  Vector2d B;       // between the camera positions, in the robot's frame at `from` but for the yaw psi_first
  Matrix2d R_turn;  // the cameras' own measure of how the robot turned
  double weight = 1.0;

  double total_weight() const {
    const double variance = link.from->variance + link.to->variance + kOdometrySigma_m * kOdometrySigma_m * link.steps;
    return weight * link.from->weight * link.to->weight / variance;
  }
  Vector2d residual(const VectorXd& t, double psi) const {
    const Vector2d t_from = t.segment<2>(2 * link.from->camera), t_to = t.segment<2>(2 * link.to->camera);
    return rotation2(psi) * B + t_from - R_turn * t_to - link.driven;
  }
};

std::vector<Equation> equations_of(const std::vector<Link>& links, const std::vector<double>& yaw) {
  std::vector<Equation> equations;
  for (const Link& link : links) {
    const double from = link.from->heading - yaw[static_cast<std::size_t>(link.from->camera)];
    const double to = link.to->heading - yaw[static_cast<std::size_t>(link.to->camera)];
    equations.push_back({link, rotation2(-from) * (link.to->position - link.from->position), rotation2(to - from)});
  }
  return equations;
}

// Least squares for (t_1 .. t_K, cos psi, sin psi), or for the t alone where psi is given.
VectorXd solve_linear(const std::vector<Equation>& equations, std::size_t cameras, const std::optional<double>& psi) {
  const Eigen::Index translations = 2 * static_cast<Eigen::Index>(cameras), unknowns = translations + (psi ? 0 : 2);
  MatrixXd H = MatrixXd::Zero(unknowns, unknowns);
  VectorXd g = VectorXd::Zero(unknowns);
  H.diagonal().head(translations).setConstant(1.0 / (kMountingSigma_m * kMountingSigma_m));
  for (const Equation& equation : equations) {
    const Link& link = equation.link;
    Matrix2d by_yaw;
    by_yaw << equation.B, quarter_turn(equation.B);
    const std::array<Matrix2d, 3> J = {Matrix2d::Identity(), -equation.R_turn, by_yaw};
    const std::array<Eigen::Index, 3> place = {2 * link.from->camera, 2 * link.to->camera, translations};
    const Vector2d target = psi ? Vector2d(link.driven - rotation2(*psi) * equation.B) : link.driven;
    const double weight = equation.total_weight();
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

// How the cameras are mounted, but for the heights.
struct PlanarMounting {
  std::vector<double> yaw;  // psi_k - psi_first
  double psi = 0.0;         // psi_first
  VectorXd t;

  // Heading and position of the robot in the levelled board frame, through the camera of a view.
  double robot_heading(const LevelView& view) const {
    return view.heading - psi - yaw[static_cast<std::size_t>(view.camera)];
  }
  Vector2d robot_position(const LevelView& view) const {
    return view.position - rotation2(robot_heading(view)) * t.segment<2>(2 * view.camera);
  }
};

PlanarMounting solve_mounting(const std::vector<Link>& links, std::vector<double> yaw) {
  std::vector<Equation> equations = equations_of(links, yaw);
  PlanarMounting mounting{std::move(yaw), 0.0, {}};
  // The first rounds are soft, so that a wheel that slipped cannot capture the start.
  double softness_m = 1.0;
  for (int round = 0; round < 8; ++round) {
    const Vector2d direction = solve_linear(equations, mounting.yaw.size(), std::nullopt).tail<2>();
    mounting.psi = direction.norm() < kMinDirection ? 0.0 : std::atan2(direction.y(), direction.x());
    mounting.t = solve_linear(equations, mounting.yaw.size(), mounting.psi);
    for (Equation& equation : equations) {
      const double off = equation.residual(mounting.t, mounting.psi).norm() / softness_m;
      equation.weight = 1.0 / (1.0 + off * off);
    }
    softness_m = std::max(0.03, 0.5 * softness_m);
  }
  return mounting;
}

// Of the cameras that saw the board, over its origin.
std::vector<std::optional<double>> mean_heights(std::size_t cameras, const LevelViews& views) {
  std::vector<std::optional<double>> means(cameras);
  std::vector<double> sums(cameras, 0.0);
  for (const LevelView& view : views) {
    const std::size_t k = static_cast<std::size_t>(view.camera);
    means[k] = means[k].value_or(0.0) + view.weight * view.height;
    sums[k] += view.weight;
  }
  for (std::size_t k = 0; k < cameras; ++k)
    if (means[k]) *means[k] /= sums[k];
  return means;
}

// Heights over the accepted planes of one camera, less `base_m`.
void collect_heights(const Observations& observations, const GroundCheck& ground, std::size_t camera, double base_m,
                     std::vector<double>* heights) {
  for (std::size_t i = 0; i < observations.ground_planes.size(); ++i)
    if (ground.accepted[i] && observations.ground_planes[i].camera == static_cast<int>(camera))
      heights->push_back(height_above(observations.ground_planes[i]).height_m - base_m);
}

// Of the boards' origins and of the cameras over the ground.
class Heights {
 public:
  Heights(const Observations& observations, const GroundCheck& ground, const std::vector<LevelViews>& level)
      : cameras_(observations.cameras.size()), boards_(level.size()) {
    for (const LevelViews& views : level) means_.push_back(mean_heights(cameras_.size(), views));
    for (std::size_t b = 0; b < boards_.size(); ++b) boards_[b] = by_planes(observations, ground, b);
    for (std::size_t k = 0; k < cameras_.size(); ++k) {
      // A camera's own planes know its height best.
      std::vector<double> heights;
      collect_heights(observations, ground, k, 0.0, &heights);
      if (!heights.empty()) cameras_[k] = median(heights);
    }
    spread();
    // Where no planes are, the lowest camera is at height zero.
    for (std::size_t b = 0; b < boards_.size(); ++b) {
      if (boards_[b]) continue;
      double lowest = std::numeric_limits<double>::infinity();
      for (const std::optional<double>& mean : means_[b])
        if (mean) lowest = std::min(lowest, *mean);
      if (std::isfinite(lowest)) boards_[b] = -lowest;
      spread();
    }
  }
  double board(std::size_t b) const { return boards_[b].value_or(0.0); }
  double camera(std::size_t k) const { return cameras_[k].value_or(0.0); }

 private:
  std::optional<double> by_planes(const Observations& observations, const GroundCheck& ground, std::size_t b) const {
    std::vector<double> offsets;
    for (std::size_t k = 0; k < cameras_.size(); ++k)
      if (means_[b][k]) collect_heights(observations, ground, k, *means_[b][k], &offsets);
    return offsets.empty() ? std::nullopt : std::optional(median(offsets));
  }

  // From boards to cameras that see them, and back.
  void spread() {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t b = 0; b < boards_.size(); ++b) {
        for (std::size_t k = 0; k < cameras_.size(); ++k) {
          const std::optional<double>& mean = means_[b][k];
          if (!mean || cameras_[k].has_value() == boards_[b].has_value()) continue;
          if (boards_[b])
            cameras_[k] = *mean + *boards_[b];
          else
            boards_[b] = *cameras_[k] - *mean;
          changed = true;
        }
      }
    }
  }

  std::vector<std::vector<std::optional<double>>> means_;  // of each board, of each camera over its origin
  std::vector<std::optional<double>> cameras_, boards_;
};

double certainty(const LevelView& view) { return view.weight / view.variance; }

// The first view that is no outlier, or the most certain one of its stop.
const LevelView& anchor_view(const LevelViews& views) {
  const auto good = std::find_if(views.begin(), views.end(), [](const LevelView& v) { return v.weight >= 0.5; });
  const LevelView* anchor = good == views.end() ? &views.front() : &*good;
  for (const LevelView& view : views)
    if (view.stop == anchor->stop && certainty(view) > certainty(*anchor)) anchor = &view;
  return *anchor;
}

// Stops without a view follow from the nearest earlier one that has one, or from the next later one.
void continue_by_odometry(const std::vector<Rigid3>& odometry, std::vector<bool> placed, std::vector<Rigid3>* poses) {
  for (std::size_t i = 1; i < poses->size(); ++i) {
    if (placed[i] || !placed[i - 1]) continue;
    (*poses)[i] = (*poses)[i - 1] * odometry[i - 1].inverse() * odometry[i];
    placed[i] = true;
  }
  for (std::size_t i = poses->size(); i-- > 1;) {
    if (placed[i - 1] || !placed[i]) continue;
    (*poses)[i - 1] = (*poses)[i] * odometry[i].inverse() * odometry[i - 1];
    placed[i - 1] = true;
  }
}

// The levelled board on the floor of the world.
struct PlanarBoard {
  double yaw;
  Vector2d position;
};

// One view ties the board to the odometry, and so to the world.
PlanarBoard place_board(const LevelView& anchor, const PlanarMounting& mounting, const std::vector<Rigid3>& odometry) {
  const Rigid3& robot = odometry[static_cast<std::size_t>(anchor.stop)];
  const double yaw = yaw_of(robot) - mounting.robot_heading(anchor);
  return {yaw, robot.translation.head<2>() - rotation2(yaw) * mounting.robot_position(anchor)};
}

// Cameras that see the same board, or are joined by a chain of such, are solved together: between others there are
// only the odometry and heights. A number for each board.
std::vector<std::size_t> groups_of(const std::vector<LevelViews>& level, std::size_t cameras) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> group(level.size());
  for (std::size_t b = 0; b < level.size(); ++b) group[b] = b;
  std::vector<std::size_t> board_of(cameras, kNone);
  for (std::size_t b = 0; b < level.size(); ++b) {
    for (const LevelView& view : level[b]) {
      std::size_t& first = board_of[static_cast<std::size_t>(view.camera)];
      if (first == kNone) first = b;
      if (group[first] != group[b]) std::replace(group.begin(), group.end(), group[b], group[first]);
    }
  }
  return group;
}

// How cameras and boards lie to each other and to the odometry.
struct PlanarRig {
  std::vector<PlanarMounting> mountings;  // of each group
  std::vector<std::size_t> group_of_board;
  std::vector<PlanarBoard> boards;  // where they were seen

  const PlanarMounting& mounting_of(const LevelView& view) const {
    return mountings[group_of_board[static_cast<std::size_t>(view.board)]];
  }
};

PlanarRig solve_rig(const std::vector<LevelViews>& level, const std::vector<Rigid3>& odometry, std::size_t cameras) {
  PlanarRig rig{std::vector<PlanarMounting>(level.size()), groups_of(level, cameras), {}};
  for (std::size_t group = 0; group < level.size(); ++group) {
    std::vector<Link> links;
    const LevelView* first = nullptr;
    for (std::size_t b = 0; b < level.size(); ++b) {
      if (rig.group_of_board[b] != group || level[b].empty()) continue;
      if (first == nullptr || level[b].front().stop < first->stop) first = &level[b].front();
      const std::vector<Link> of_board = make_links(level[b], odometry, cameras);
      links.insert(links.end(), of_board.begin(), of_board.end());
    }
    if (first != nullptr)
      rig.mountings[group] =
          solve_mounting(links, relate_yaws(cameras, static_cast<std::size_t>(first->camera), links));
  }
  for (const LevelViews& views : level)
    rig.boards.push_back(views.empty() ? PlanarBoard{0.0, Vector2d::Zero()}
                                       : place_board(anchor_view(views), rig.mounting_of(views.front()), odometry));
  return rig;
}

std::vector<Rigid3> place_robot(const std::vector<LevelViews>& level, const PlanarRig& rig,
                                const std::vector<Rigid3>& odometry) {
  std::vector<const LevelView*> by_stop(odometry.size(), nullptr);
  for (const LevelViews& views : level)
    for (const LevelView& view : views) {
      const LevelView*& best = by_stop[static_cast<std::size_t>(view.stop)];
      if (view.weight >= kLeastPlanarWeight && (best == nullptr || certainty(view) > certainty(*best))) best = &view;
    }
  std::vector<Rigid3> poses = odometry;
  std::vector<bool> placed(odometry.size(), false);
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    if (by_stop[i] == nullptr) continue;
    const LevelView& view = *by_stop[i];
    const PlanarBoard& board = rig.boards[static_cast<std::size_t>(view.board)];
    const Vector2d p = board.position + rotation2(board.yaw) * rig.mounting_of(view).robot_position(view);
    poses[i] = planar_pose(p.x(), p.y(), wrap_angle(board.yaw + rig.mounting_of(view).robot_heading(view)));
    placed[i] = true;
  }
  continue_by_odometry(odometry, placed, &poses);
  return poses;
}

std::vector<std::optional<Rigid3>> place_cameras(const std::vector<LevelViews>& level, const PlanarRig& rig,
                                                 const Heights& heights, const std::vector<Matrix3d>& R_level_camera) {
  std::vector<std::optional<Rigid3>> T_robot_camera(R_level_camera.size());
  for (const LevelViews& views : level)
    for (const LevelView& view : views) {
      const auto k = static_cast<std::size_t>(view.camera);
      if (T_robot_camera[k]) continue;
      const PlanarMounting& mounting = rig.mounting_of(view);
      const Vector2d t = mounting.t.segment<2>(2 * static_cast<Eigen::Index>(k));
      T_robot_camera[k] =
          Rigid3(Eigen::Quaterniond(rotation_z(mounting.psi + mounting.yaw[k]).toRotationMatrix() * R_level_camera[k]),
                 Vector3d(t.x(), t.y(), heights.camera(k)));
    }
  return T_robot_camera;
}

}  // namespace

InitialGuess initial_guess(const Observations& observations, const std::vector<ViewPose>& views,
                           const TrajectoryAlignment& alignment, const GroundCheck& ground) {
  const std::size_t cameras = observations.cameras.size();
  const std::vector<Rigid3> odometry = odometry_poses(observations);
  InitialGuess guess;
  guess.T_robot_camera.resize(cameras);
  guess.T_world_robot = odometry;
  if (views.empty()) return guess;
  std::vector<Matrix3d> R_level_board;
  for (const Vector3d& up : alignment.up_board) R_level_board.push_back(levelling(up));
  const std::vector<Matrix3d> R_level_camera = camera_levelling(cameras, views, alignment);
  const std::vector<LevelViews> level = level_views(views, alignment.view_weights, R_level_board, R_level_camera);
  const PlanarRig rig = solve_rig(level, odometry, cameras);
  const Heights heights(observations, ground, level);
  guess.T_robot_camera = place_cameras(level, rig, heights, R_level_camera);
  for (std::size_t b = 0; b < level.size(); ++b) {
    const PlanarBoard& board = rig.boards[b];
    const Rigid3 T(Eigen::Quaterniond(rotation_z(board.yaw).toRotationMatrix() * R_level_board[b]),
                   Vector3d(board.position.x(), board.position.y(), heights.board(b)));
    if (b == 0)
      guess.T_world_board = T;
    else
      guess.T_world_more_boards.push_back(T);
  }
  guess.T_world_robot = place_robot(level, rig, odometry);
  return guess;
}

}  // namespace rigproof
