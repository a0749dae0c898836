#include "rigproof/calib/plan/suggest.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>

#include "floor.h"
#include "forecast.h"
#include "measurements.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/exclusions.h"
#include "rigproof/core/random.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

using suggest::CalibrationSoFar;
using suggest::Floor;
using suggest::Forecast;
using suggest::Foresight;
using suggest::Place;
using suggest::StopInformation;

constexpr double kImpossible = std::numeric_limits<double>::infinity();

void check(const SuggestOptions& options) {
  Problems problems;
  const auto require = [&problems](bool holds, const char* field, double value, const char* message) {
    if (!holds) problems.add({"", 0, field, number_text(value), message});
  };
  require(options.stops >= 1 && options.stops <= 20, "stops", options.stops, "allowed: 1 to 20");
  require(options.candidates >= 10 && options.candidates <= 100000, "candidates", options.candidates,
          "allowed: 10 to 100000");
  require(options.clearance_m >= 0.0, "clearance_m", options.clearance_m, "must not be negative");
  require(options.reach_m > 0.0, "reach_m", options.reach_m, "must be positive");
  require(options.min_turn_rad >= 0.0 && options.min_turn_rad < 1.6, "min_turn_rad", options.min_turn_rad,
          "allowed: 0 to 1.6");
  require(options.min_cameras >= 1, "min_cameras", options.min_cameras, "must be at least 1");
  require(options.limits.xy_m > 0.0 && options.limits.z_m > 0.0 && options.limits.angle_rad > 0.0, "limits",
          options.limits.xy_m, "all must be positive");
  if (options.area) {
    require(options.area->x_min_m < options.area->x_max_m, "area", options.area->x_min_m, "x must increase");
    require(options.area->y_min_m < options.area->y_max_m, "area", options.area->y_min_m, "y must increase");
  }
  problems.throw_if_any();
}

// Smooth enough that every candidate that helps a little is told from one that does not.
double worst_axis(const Eigen::VectorXd& relative_sigmas) {
  constexpr double kPower = 8.0;
  const double largest = relative_sigmas.maxCoeff();
  return largest * std::pow((relative_sigmas / largest).array().pow(kPower).mean(), 1.0 / kPower);
}

// What calibration knows, and how it foresees what more the robot may do.
struct Outlook {
  const CalibrationSoFar& knowledge;
  const SuggestOptions& options;
  Floor floor;
  Foresight foresight;
  Forecast forecast;

  const CalibrationState& state() const { return knowledge.estimate.state; }
  Place last_place() const { return Place::of(state().T_world_robot.back()); }
  bool enough(const std::vector<int>& cameras) const { return static_cast<int>(cameras.size()) >= options.min_cameras; }
};

// From there, and turned as far to either side as commands in whole degrees may leave it.
bool sees_board_when_rounded(const Outlook& outlook, const Place& place) {
  const double margin_rad = deg_to_rad(1.0);
  std::vector<int> cameras = outlook.foresight.cameras_with_board(place.T_world_robot());
  for (const double turn_rad : {-margin_rad, margin_rad}) {
    if (!outlook.enough(cameras)) return false;
    const std::vector<int> turned =
        outlook.foresight.cameras_with_board(place.T_world_robot() * planar_pose(0.0, 0.0, turn_rad));
    std::vector<int> both;
    std::set_intersection(cameras.begin(), cameras.end(), turned.begin(), turned.end(), std::back_inserter(both));
    cameras = both;
  }
  return outlook.enough(cameras);
}

// Anywhere in the area, with one of the cameras looking about at the board.
Place aimed_place(const Outlook& outlook, const std::vector<std::size_t>& posed, RandomStream* random) {
  const DriveArea& area = outlook.floor.area();
  const double x = random->uniform(area.x_min_m, area.x_max_m), y = random->uniform(area.y_min_m, area.y_max_m);
  const Eigen::Vector3d p = outlook.floor.T_world_first() * Eigen::Vector3d(x, y, 0.0);
  const std::size_t c = posed[random->below(static_cast<std::uint32_t>(posed.size()))];
  const Rigid3& X = outlook.state().T_robot_camera[c];
  const Camera& lens = outlook.knowledge.basis.used.cameras[c].camera;
  const Eigen::Vector3d axis = X.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d board = outlook.state().T_world_board * outlook.knowledge.basis.used.board.centre();
  const double half_view = std::atan(0.5 * lens.width_px / lens.fx_px);
  const double yaw = std::atan2(board.y() - p.y(), board.x() - p.x()) - std::atan2(axis.y(), axis.x()) +
                     random->uniform(-half_view, half_view);
  return {p.x(), p.y(), wrap_angle(yaw)};
}

std::vector<Place> candidates_of(const Outlook& outlook) {
  std::vector<std::size_t> posed;  // cameras that can be aimed
  for (std::size_t c = 0; c < outlook.knowledge.has_pose.size(); ++c)
    if (outlook.knowledge.has_pose[c]) posed.push_back(c);
  std::vector<Place> places;
  RandomStream random(outlook.options.seed, "suggested places");
  const int tries = 200 * outlook.options.candidates;
  for (int i = 0; i < tries && static_cast<int>(places.size()) < outlook.options.candidates; ++i) {
    const Place place = aimed_place(outlook, posed, &random);
    if (outlook.floor.may_stand(place) && sees_board_when_rounded(outlook, place)) places.push_back(place);
  }
  return places;
}

/// Candidates by number.
struct Choice {
  std::vector<std::size_t> places;
  std::set<std::size_t> given_up = {};  ///< that no command leads to
  double score = kImpossible;

  bool may_take(std::size_t candidate) const {
    return given_up.count(candidate) == 0 && std::find(places.begin(), places.end(), candidate) == places.end();
  }
  Choice without(std::size_t candidate) const {
    Choice rest = *this;
    rest.given_up.insert(candidate);
    rest.places.erase(std::find(rest.places.begin(), rest.places.end(), candidate));
    return rest;
  }
};

// Chooses among candidates by what they would tell.
struct Chooser {
  const Outlook& outlook;
  const AcceptLimits& limits;
  const std::vector<Place>& places;
  std::vector<StopInformation> information;

  double score(const std::vector<std::size_t>& chosen) const {
    std::vector<const StopInformation*> stops;
    for (const std::size_t i : chosen) stops.push_back(&information[i]);
    const std::optional<Eigen::MatrixXd> joint = outlook.forecast.regular_covariance(stops);
    if (!joint) return kImpossible;
    Eigen::VectorXd inverse_limits(joint->rows());
    for (Eigen::Index i = 0; i < joint->rows(); ++i)
      inverse_limits[i] = 1.0 / (i % 6 < 2 ? limits.xy_m : i % 6 == 2 ? limits.z_m : limits.angle_rad);
    const Eigen::MatrixXd relative = inverse_limits.asDiagonal() * *joint * inverse_limits.asDiagonal();
    switch (outlook.options.criterion) {
      case SuggestCriterion::kDeterminant:
        return 2.0 * relative.llt().matrixLLT().diagonal().array().log().sum();
      case SuggestCriterion::kEigenvalue:
        return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(relative, Eigen::EigenvaluesOnly)
            .eigenvalues()
            .maxCoeff();
      case SuggestCriterion::kWorstAxis:
        break;
    }
    return worst_axis(relative.diagonal().cwiseMax(0.0).cwiseSqrt());
  }

  // The best candidate at the given position of the choice; false if none beats what is there.
  bool improve(std::size_t position, Choice* choice) const {
    std::vector<std::size_t> trial = choice->places;
    bool better = false;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!choice->may_take(i)) continue;
      trial[position] = i;
      const double value = score(trial);
      if (value >= choice->score) continue;
      choice->score = value;
      choice->places[position] = i;
      better = true;
    }
    return better;
  }

  // With as many places as are wanted and help, each the next best one, then exchanged.
  Choice completed(Choice choice) const {
    constexpr int kExchanges = 2;
    const std::size_t wanted = std::min(static_cast<std::size_t>(outlook.options.stops), places.size());
    while (choice.places.size() < wanted) {
      choice.places.push_back(places.size());  // no candidate yet
      choice.score = kImpossible;
      if (improve(choice.places.size() - 1, &choice)) continue;
      choice.places.pop_back();
      break;
    }
    bool better = choice.places.size() > 1;
    for (int round = 0; better && round < kExchanges; ++round) {
      better = false;
      for (std::size_t i = 0; i < choice.places.size(); ++i) better = improve(i, &choice) || better;
    }
    return choice;
  }
};

// A metre of driving costs as much as a radian of turning; a blocked way is only taken if there is no other.
double cost_between(const Floor& floor, const Place& from, const Place& to) {
  constexpr double kBlocked = 1e3;
  const DriveCommand command = suggest::command_between(from, to, 0.0);
  return std::abs(command.distance_m) + std::abs(command.turn_before_rad) + std::abs(command.turn_after_rad) +
         (floor.may_drive(from, to) ? 0.0 : kBlocked);
}

std::vector<std::size_t> shortest(const Outlook& outlook, const std::vector<Place>& places,
                                  std::vector<std::size_t> order) {
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> best = order;
  double least = kImpossible;
  do {
    double cost = 0.0;
    Place from = outlook.last_place();
    for (const std::size_t i : order) {
      cost += cost_between(outlook.floor, from, places[i]);
      from = places[i];
    }
    if (cost >= least) continue;
    least = cost;
    best = order;
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

// The shortest drive through the chosen places that keeps clear of the board.
std::vector<std::size_t> in_driving_order(const Outlook& outlook, const std::vector<Place>& places,
                                          std::vector<std::size_t> left) {
  std::vector<std::size_t> order;
  if (left.size() <= 6) return shortest(outlook, places, std::move(left));
  for (Place from = outlook.last_place(); !left.empty(); from = places[order.back()]) {
    const auto cost = [&](std::size_t candidate) { return cost_between(outlook.floor, from, places[candidate]); };
    const auto next =
        std::min_element(left.begin(), left.end(), [&](std::size_t a, std::size_t b) { return cost(a) < cost(b); });
    order.push_back(*next);
    left.erase(next);
  }
  return order;
}

// Absent if too few cameras see the board from where the command leads.
std::optional<SuggestedStop> seen_from(const Outlook& outlook, const Place& from, const DriveCommand& command) {
  const Rigid3 T_world_robot = from.T_world_robot() * command.motion();
  const std::vector<int> cameras = outlook.foresight.cameras_with_board(T_world_robot);
  if (!outlook.enough(cameras)) return std::nullopt;
  return SuggestedStop{command, T_world_robot, cameras};
}

// As close to the place as whole degrees and centimetres lead from which the board is seen: where it is missed, with
// small turns after all, then aimed anew.
std::optional<SuggestedStop> stop_at(const Outlook& outlook, const Place& from, const Place& to) {
  const std::optional<SuggestedStop> plain =
      seen_from(outlook, from, suggest::command_between(from, to, outlook.options.min_turn_rad));
  if (plain) return plain;
  constexpr int kMostAimed_deg = 5;
  const DriveCommand exact = suggest::command_between(from, to, 0.0);
  for (int aimed_deg = 0; aimed_deg <= kMostAimed_deg; ++aimed_deg) {
    for (const int sense : {1, -1}) {
      DriveCommand command = exact;
      (command.distance_m != 0.0 ? command.turn_after_rad : command.turn_before_rad) += deg_to_rad(sense * aimed_deg);
      if (const std::optional<SuggestedStop> stop = seen_from(outlook, from, command)) return stop;
    }
  }
  return std::nullopt;
}

// Commands are rounded, and the robot is where they lead it. Returns a place from where the board is out of sight
// then, whatever the command; else absent.
std::optional<std::size_t> command(const Outlook& outlook, const std::vector<Place>& places,
                                   const std::vector<std::size_t>& order, Suggestion* suggestion) {
  suggestion->stops.clear();
  std::vector<Finding> notes;
  Place from = outlook.last_place();
  for (const std::size_t candidate : order) {
    const std::optional<SuggestedStop> stop = stop_at(outlook, from, places[candidate]);
    if (!stop) return candidate;
    if (!outlook.floor.may_drive(from, Place::of(stop->T_world_robot)))
      notes.push_back(Finding("suggest.near_board", {{"stop", suggestion->stops.size() + 1}}));
    from = Place::of(stop->T_world_robot);
    suggestion->stops.push_back(*stop);
  }
  if (suggestion->stops.size() < static_cast<std::size_t>(outlook.options.stops))
    notes.push_back(Finding("suggest.few_places", {{"places", suggestion->stops.size()}}));
  suggestion->notes = std::move(notes);
  return std::nullopt;
}

// What `ml` makes of observations free of noise: whether the stops determine everything.
Result foreseen(const Outlook& outlook, const Observations& observations) {
  MlOptions options = outlook.options.ml;
  options.estimate_corner_level = options.estimate_plane_level = false;
  options.suspension_height_sigma_m = outlook.forecast.levels().suspension_height_m;
  options.suspension_tilt_sigma_rad = outlook.forecast.levels().suspension_tilt_rad;
  return estimate_maximum_likelihood(observations, options).result;
}

// What the method refuses has no figure.
AxisSigmas only_answered(const EstimatedTransform* transform, AxisSigmas sigmas) {
  for (std::size_t axis = 0; axis < 6; ++axis)
    if (transform == nullptr || !transform->observable[axis]) sigmas[axis].reset();
  return sigmas;
}

AxisSigmas stated_of(const Result& result, const std::string& robot, const std::string& camera) {
  const EstimatedTransform* transform = result.find(robot, camera);
  AxisSigmas sigmas;
  if (transform == nullptr || !transform->covariance) return sigmas;
  for (Eigen::Index axis = 0; axis < 6; ++axis)
    sigmas[static_cast<std::size_t>(axis)] = std::sqrt((*transform->covariance)(axis, axis));
  return only_answered(transform, sigmas);
}

// What the forecast does not hold (where it is open which odometry model is true, the method states both) is taken
// to shrink as the rest does.
AxisSigmas in_proportion(AxisSigmas then, const AxisSigmas& now, const AxisSigmas& stated) {
  for (std::size_t axis = 0; axis < 6; ++axis)
    if (then[axis] && now[axis] && stated[axis]) *then[axis] *= *stated[axis] / *now[axis];
  return then;
}

void add_cameras(const CalibrationSoFar& knowledge, const Result& result_then, const std::vector<AxisSigmas>& now,
                 const std::vector<AxisSigmas>& then, Suggestion* suggestion) {
  const std::string& robot = knowledge.basis.used.robot_frame;
  std::size_t row = 0;
  for (std::size_t c = 0; c < knowledge.has_pose.size(); ++c) {
    const std::string& name = knowledge.basis.used.cameras[c].name;
    if (!knowledge.has_pose[c]) {
      const std::vector<Exclusion>& left_out = knowledge.basis.used.exclusions;
      suggestion->notes.push_back(
          with_lack_of_views(Finding("suggest.no_pose"), left_out, static_cast<int>(c)).of(name));
      continue;
    }
    const AxisSigmas stated = stated_of(knowledge.estimate.result, robot, name);
    suggestion->cameras.push_back(
        {name, stated, only_answered(result_then.find(robot, name), in_proportion(then[row], now[row], stated))});
    ++row;
  }
}

void foretell(const Outlook& outlook, Suggestion* suggestion) {
  Observations observations = outlook.foresight.as_expected(outlook.forecast.levels());
  const Result now = foreseen(outlook, observations);
  if (now.status < suggestion->status_now) suggestion->notes.emplace_back("suggest.contradicting_data");
  std::vector<StopInformation> information;
  Place before = outlook.last_place();
  for (const SuggestedStop& stop : suggestion->stops) {
    information.push_back(outlook.forecast.information_of(outlook.foresight, Place::of(stop.T_world_robot)));
    outlook.foresight.append_stop(before.T_world_robot(), stop.T_world_robot, &observations);
    before = Place::of(stop.T_world_robot);
  }
  const Result then = foreseen(outlook, observations);
  suggestion->status_then = then.status;
  suggestion->reasons_then = then.reasons;
  if (const auto measure = suggest::what_to_measure(then, suggestion->limits)) suggestion->notes.push_back(*measure);
  std::vector<const StopInformation*> stops;
  for (const StopInformation& stop : information) stops.push_back(&stop);
  add_cameras(outlook.knowledge, then, outlook.forecast.sigmas({}), outlook.forecast.sigmas(stops), suggestion);
}

}  // namespace

Suggestion suggest_stops(const Observations& observations, const SuggestOptions& options) {
  check(options);
  const AcceptLimits limits = observations.accept.value_or(options.limits);
  const CalibrationSoFar knowledge = suggest::calibration_so_far(observations, options.ml);
  const CalibrationState& state = knowledge.estimate.state;
  const Outlook outlook{knowledge, options,
                        Floor(options, state.T_world_robot, knowledge.basis.used.board, state.T_world_board),
                        Foresight(knowledge, options), Forecast(knowledge)};
  const std::vector<Place> places = candidates_of(outlook);
  Chooser chooser{outlook, limits, places, {}};
  for (const Place& place : places)
    chooser.information.push_back(outlook.forecast.information_of(outlook.foresight, place));
  Suggestion suggestion;
  suggestion.limits = limits;
  suggestion.status_now = knowledge.estimate.result.status;
  suggestion.reasons_now = knowledge.estimate.result.reasons;
  suggestion.T_world_board = state.T_world_board;
  suggestion.T_world_robot = state.T_world_robot;
  Choice choice = chooser.completed({});
  while (const auto out_of_sight =
             command(outlook, places, in_driving_order(outlook, places, choice.places), &suggestion))
    choice = chooser.completed(choice.without(*out_of_sight));
  foretell(outlook, &suggestion);
  return suggestion;
}

}  // namespace rigproof
