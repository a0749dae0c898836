#include "steps.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "bending.h"
#include "rigproof/core/conventions.h"

namespace rigproof::ml {
namespace {

// Chi-squares of six dimensions of the largest score, and of the step of the solution that has one. See
// docs/measurements/refusals.md for what healthy drives reach.
constexpr double kWorthASolution = 36.0;
// What moved can pass for odometry that is far worse than wheels are, which then hides it: 26 of a camera that was
// knocked by 3 degrees, at 73 mm a stop.
constexpr double kWorthASolutionAtPoorOdometry = 12.0;
constexpr double kPoorOdometry_m = 0.02, kPoorOdometry_rad = 0.03;
constexpr double kSure = 49.0;
// -2 ln of a likelihood ratio that decides between steps.
constexpr double kDecides = 10.0;

using Bodies = std::vector<int>;

bool has(const Bodies& bodies, int body) { return std::find(bodies.begin(), bodies.end(), body) != bodies.end(); }

// Stops at which a view of one of the bodies is used, ascending: only there a split tells one stop from the other.
std::vector<int> stops_that_see(const Preparation& prepared, const Bodies& bodies) {
  std::vector<int> stops;
  for (const BoardView& view : prepared.used.board_views)
    if (has(bodies, Step::board(view.board)) || has(bodies, view.camera)) stops.push_back(view.stop);
  std::sort(stops.begin(), stops.end());
  stops.erase(std::unique(stops.begin(), stops.end()), stops.end());
  return stops;
}

// Of a camera of which most views were left out on one side of a split and few on the other.
std::optional<StepScore> by_left_out(const Preparation& prepared, const Fit& fit, int camera) {
  std::vector<std::pair<int, bool>> views;
  for (std::size_t v = 0; v < prepared.used.board_views.size(); ++v)
    if (prepared.used.board_views[v].camera == camera && prepared.has_pose(v))
      views.emplace_back(prepared.used.board_views[v].stop, fit.view_left_out[v]);
  std::sort(views.begin(), views.end());
  const auto out = [&](std::size_t from, std::size_t to) {
    return std::count_if(views.begin() + static_cast<long>(from), views.begin() + static_cast<long>(to),
                         [](const auto& view) { return view.second; });
  };
  constexpr double kClearly = 0.6;
  double best = kClearly;
  std::optional<StepScore> found;
  const std::size_t n = views.size(), least = kLeastViewsOfStep;
  for (std::size_t i = least; i + least <= n; ++i) {
    const double before = static_cast<double>(out(0, i)) / static_cast<double>(i),
                 after = static_cast<double>(out(i, n)) / static_cast<double>(n - i);
    if (std::abs(after - before) <= best || out(0, n) < static_cast<long>(least)) continue;
    best = std::abs(after - before);
    found = StepScore{{views[i].first, {camera}}, std::numeric_limits<double>::infinity()};
  }
  return found;
}

// Views are not stops: several cameras may see a board of its own from few.
bool may_split(const Preparation& prepared, const StepScore& score) {
  return stops_that_see(prepared, score.step.bodies).size() >= 2 * static_cast<std::size_t>(kLeastViewsOfStep);
}

// The best split of each group of bodies, the likeliest first.
std::vector<StepScore> candidates(const Preparation& prepared, const Fit& fit, const std::vector<StepScore>& scores) {
  std::map<Bodies, StepScore> best;
  const auto look = [&best](const StepScore& score) {
    const auto [place, is_new] = best.emplace(score.step.bodies, score);
    if (!is_new && score.square > place->second.square) place->second = score;
  };
  const bool poor = fit.noise.odometry_xy_m > kPoorOdometry_m || fit.noise.odometry_yaw_rad > kPoorOdometry_rad;
  for (const StepScore& score : scores)
    if (score.square > (poor ? kWorthASolutionAtPoorOdometry : kWorthASolution) && may_split(prepared, score))
      look(score);
  for (const int c : prepared.solved_cameras())
    if (const std::optional<StepScore> score = by_left_out(prepared, fit, c)) look(*score);
  std::vector<StepScore> all;
  for (const auto& [bodies, score] : best) all.push_back(score);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.square > b.square; });
  return all;
}

// -2 ln of the likelihood, where what was left out counts as very wrong.
double unexplained(const Preparation& prepared, const Fit& fit) {
  constexpr double kVeryWrong = 1e4;  // whitened square
  double left_out = 0.0;
  for (std::size_t v = 0; v < prepared.used.board_views.size(); ++v)
    if (fit.view_left_out[v]) left_out += static_cast<double>(prepared.used.board_views[v].corners.size());
  return fit.minus_two_log_likelihood + left_out * CauchyLoss().cost(kVeryWrong);
}

struct Tried {
  Fit fit;
  double unexplained = std::numeric_limits<double>::infinity();
};

Tried try_step(const Preparation& prepared, const Fit& without, const Step& step) {
  Tried tried{fit_with_step(prepared, without, step), 0.0};
  tried.unexplained = unexplained(prepared, tried.fit);
  return tried;
}

// From the split of a score to the likeliest one.
Tried best_split(const Preparation& prepared, const Fit& without, const Step& start) {
  const std::vector<int> stops = stops_that_see(prepared, start.bodies);
  const int n = static_cast<int>(stops.size()), least = kLeastViewsOfStep;
  int at = std::clamp(static_cast<int>(std::lower_bound(stops.begin(), stops.end(), start.split) - stops.begin()),
                      least, n - least);
  const auto at_stop = [&](int i) {
    return try_step(prepared, without, {stops[static_cast<std::size_t>(i)], start.bodies});
  };
  Tried best = at_stop(at);
  const int spacing = (static_cast<int>(prepared.used.stops.size()) + kSplitsAtFirst - 1) / kSplitsAtFirst;
  for (int step = std::max(1, spacing / 2); step >= 1; step /= 2)
    for (const int side : {-1, 1})
      for (int next = at + side * step; next >= least && next <= n - least; next += side * step) {
        Tried tried = at_stop(next);
        if (!(tried.unexplained < best.unexplained)) break;
        best = std::move(tried);
        at = next;
      }
  return best;
}

// How far a body moved: second pose less first, in the chart of transform_error(), and how far that is beyond chance.
struct Motion {
  int body;
  Vector6d change;
  double square;
};
Motion motion_of(const Fit& fit, const Layout& layout, const GlobalCovariance& covariance, int index) {
  constexpr double kOpen = 1e6;  // variance of what the data leave open
  const int body = fit.step.bodies[static_cast<std::size_t>(index)];
  const Rigid3 &before = fit.state.first_pose(body), &after = fit.state.second_poses[static_cast<std::size_t>(index)];
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, layout.globals());
  const int first = layout.body(body), second = layout.second(index);
  J.block<3, 3>(0, first) = -Eigen::Matrix3d::Identity();
  J.block<3, 3>(3, first + 3) = -before.rotation_matrix();
  J.block<3, 3>(0, second).setIdentity();
  J.block<3, 3>(3, second + 3) = after.rotation_matrix();
  const Eigen::MatrixXd open = J * covariance.free_directions;
  const Matrix6d variance = J * covariance.covariance * J.transpose() + kOpen * open * open.transpose();
  const Vector6d change = transform_error(after, before);
  const Vector6d unit = variance.diagonal().cwiseSqrt().cwiseInverse(), scaled = unit.cwiseProduct(change);
  const Matrix6d correlation = unit.asDiagonal() * variance * unit.asDiagonal();
  return {body, change, scaled.dot(correlation.ldlt().solve(scaled))};
}

double turn_deg(const Vector6d& change) { return rad_to_deg(change.tail<3>().norm()); }
double shift_mm(const Vector6d& change) { return 1e3 * change.head<3>().norm(); }

struct Examined {
  Tried tried;
  std::vector<Motion> motions;
  double square = 0.0;  // of the motion that is farthest beyond chance
  double bent = 0.0;
};

std::optional<Examined> examine(const Preparation& prepared, const Fit& without, Tried tried) {
  const std::optional<GlobalCovariance> covariance = stated_covariance(prepared, tried.fit);
  if (!covariance) return std::nullopt;
  const Problem problem = problem_at(prepared, tried.fit, tried.fit.noise);
  Examined examined{std::move(tried), {}, 0.0, 0.0};
  const Fit& fit = examined.tried.fit;
  for (std::size_t i = 0; i < fit.step.bodies.size(); ++i) {
    examined.motions.push_back(motion_of(fit, problem.layout(), *covariance, static_cast<int>(i)));
    examined.square = std::max(examined.square, examined.motions.back().square);
  }
  examined.bent = bent_by(without.state, prepared, fit, *covariance);
  return examined;
}

Finding finding_of(const Preparation& prepared, const Examined& examined, bool bends) {
  const Step& step = examined.tried.fit.step;
  const std::vector<int> stops = stops_that_see(prepared, step.bodies);
  const auto after = std::lower_bound(stops.begin(), stops.end(), step.split);
  const Motion& most = *std::max_element(examined.motions.begin(), examined.motions.end(),
                                         [](const Motion& a, const Motion& b) { return a.square < b.square; });
  const bool board = Step::is_board(most.body);
  const char* code =
      board ? (bends ? "board.moved" : "board.moved_slightly") : (bends ? "camera.moved" : "camera.moved_slightly");
  Finding finding(code, {{"from", *(after - 1)},
                         {"to", *after},
                         {"from_s", prepared.used.stops[static_cast<std::size_t>(*(after - 1))].stamp_s},
                         {"to_s", prepared.used.stops[static_cast<std::size_t>(*after)].stamp_s},
                         {"shift_mm", shift_mm(most.change)},
                         {"turn_deg", turn_deg(most.change)},
                         {"deviations", std::sqrt(most.square)}});
  if (board && prepared.used.boards() > 1) finding = finding.with({{"board", Step::board_of(most.body) + 1}});
  for (const Motion& motion : examined.motions)
    if (!Step::is_board(motion.body) && motion.square > kSure)
      finding.cameras.push_back(prepared.original.cameras[static_cast<std::size_t>(motion.body)].name);
  return finding.at({*after});
}

// A step that would be stated wrongly by little, or that is too small for anybody to care, is worth a warning. What a
// camera moved is wrong in its pose in another camera, too, which is better known than that in the robot.
bool worth_refusing(const Examined& examined) {
  constexpr double kMovedSquare = 100.0, kTurn_deg = 0.1, kShift_mm = 3.0;
  return std::any_of(examined.motions.begin(), examined.motions.end(), [&examined](const Motion& motion) {
    const bool bends = examined.bent > kBentSigmas || (!Step::is_board(motion.body) && motion.square > kMovedSquare);
    return bends && (turn_deg(motion.change) > kTurn_deg || shift_mm(motion.change) > kShift_mm);
  });
}

}  // namespace

std::optional<FoundStep> find_step(const Preparation& prepared, const Fit& fit, const std::vector<StepScore>& scores) {
  constexpr std::size_t kMostTried = 4;
  const std::vector<StepScore> worth = candidates(prepared, fit, scores);
  std::vector<Examined> sure;
  for (std::size_t i = 0; i < std::min(kMostTried, worth.size()); ++i) {
    auto examined = examine(prepared, fit, best_split(prepared, fit, worth[i].step));
    if (examined && examined->square > kSure && examined->tried.unexplained < unexplained(prepared, fit))
      sure.push_back(std::move(*examined));
  }
  if (sure.empty()) return std::nullopt;
  std::stable_sort(sure.begin(), sure.end(),
                   [](const Examined& a, const Examined& b) { return a.tried.unexplained < b.tried.unexplained; });
  FoundStep found;
  found.fit = sure.front().tried.fit;
  found.deviations = std::sqrt(sure.front().square);
  found.gain = unexplained(prepared, fit) - sure.front().tried.unexplained;
  found.bends = worth_refusing(sure.front());
  for (const Examined& step : sure) {
    if (step.tried.unexplained > sure.front().tried.unexplained + kDecides) break;
    found.findings.push_back(finding_of(prepared, step, found.bends));
    if (found.findings.size() > 1) found.findings.back() = found.findings.back().with({{"joined_by", "or"}});
  }
  return found;
}

}  // namespace rigproof::ml
