#include "rigproof/calib/plan/suggest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "choice.h"
#include "measurements.h"
#include "outlook.h"
#include "rigproof/calib/diagnose/turning_point.h"
#include "rigproof/calib/estimate/covariance.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/exclusions.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

using suggest::CalibrationSoFar;
using suggest::Choice;
using suggest::Chooser;
using suggest::cost_between;
using suggest::Floor;
using suggest::Forecast;
using suggest::Foresight;
using suggest::Look;
using suggest::Outlook;
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
  require(options.min_gain >= 0.0 && options.min_gain < 1.0, "min_gain", options.min_gain, "allowed: 0 to 1");
  require(options.limits.xy_m > 0.0 && options.limits.z_m > 0.0 && options.limits.angle_rad > 0.0, "limits",
          options.limits.xy_m, "all must be positive");
  if (options.area) {
    require(options.area->x_min_m < options.area->x_max_m, "area", options.area->x_min_m, "x must increase");
    require(options.area->y_min_m < options.area->y_max_m, "area", options.area->y_min_m, "y must increase");
  }
  problems.throw_if_any();
}

std::vector<std::size_t> shortest(const Outlook& outlook, const Place& start, const std::vector<Place>& places,
                                  std::vector<std::size_t> order) {
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> best = order;
  double least = kImpossible;
  do {
    double cost = 0.0;
    Place from = start;
    for (const std::size_t i : order) {
      cost += cost_between(outlook, from, places[i]);
      from = places[i];
    }
    if (cost >= least) continue;
    least = cost;
    best = order;
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

// The shortest drive from the start through the chosen places that keeps clear of the board.
std::vector<std::size_t> in_driving_order(const Outlook& outlook, const Place& start, const std::vector<Place>& places,
                                          std::vector<std::size_t> left) {
  std::vector<std::size_t> order;
  if (left.size() <= 6) return shortest(outlook, start, places, std::move(left));
  for (Place from = start; !left.empty(); from = places[order.back()]) {
    const auto cost = [&](std::size_t candidate) { return cost_between(outlook, from, places[candidate]); };
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
  return SuggestedStop{command, T_world_robot, cameras, {}};
}

// As close to the place as whole degrees and centimetres lead from which the board is seen: where it is missed, with
// small turns after all, then aimed anew.
std::optional<SuggestedStop> stop_at(const Outlook& outlook, const Place& from, const Place& to) {
  const std::optional<SuggestedStop> plain = seen_from(
      outlook, from, suggest::command_between(from, to, outlook.options.min_turn_rad, outlook.turns_about_m()));
  if (plain) return plain;
  constexpr int kMostAimed_deg = 5;
  const DriveCommand exact = suggest::command_between(from, to, 0.0, outlook.turns_about_m());
  for (int aimed_deg = 0; aimed_deg <= kMostAimed_deg; ++aimed_deg) {
    for (const int sense : {1, -1}) {
      DriveCommand command = exact;
      (command.distance_m != 0.0 ? command.turn_after_rad : command.turn_before_rad) += deg_to_rad(sense * aimed_deg);
      if (const std::optional<SuggestedStop> stop = seen_from(outlook, from, command)) return stop;
    }
  }
  return std::nullopt;
}

// Turns that show the board to cameras that have not seen it, the least turning first.
std::vector<SuggestedStop> looking_stops(const Outlook& outlook) {
  const std::vector<Look> looks = suggest::looks_for_board(outlook);
  std::vector<Place> places;
  std::vector<std::size_t> all;
  for (const Look& look : looks) {
    all.push_back(places.size());
    places.push_back(look.place);
  }
  std::vector<SuggestedStop> stops;
  Place from = outlook.last_place();
  for (const std::size_t i : in_driving_order(outlook, from, places, all)) {
    const DriveCommand command =
        suggest::command_between(from, places[i], outlook.options.min_turn_rad, outlook.turns_about_m());
    const Rigid3 T_world_robot = from.T_world_robot() * command.motion();
    stops.push_back({command, T_world_robot, outlook.foresight.cameras_with_board(T_world_robot), looks[i].hoped});
    from = Place::of(T_world_robot);
  }
  return stops;
}

// After the stops that are there already. Commands are rounded, and the robot is where they lead it. Returns a place
// from where the board is out of sight then, whatever the command; else absent.
std::optional<std::size_t> command(const Outlook& outlook, const std::vector<Place>& places,
                                   const std::vector<std::size_t>& order, std::vector<SuggestedStop>* stops) {
  Place from = stops->empty() ? outlook.last_place() : Place::of(stops->back().T_world_robot);
  for (const std::size_t candidate : order) {
    const std::optional<SuggestedStop> stop = stop_at(outlook, from, places[candidate]);
    if (!stop) return candidate;
    from = Place::of(stop->T_world_robot);
    stops->push_back(*stop);
  }
  return std::nullopt;
}

void note_drive(const Outlook& outlook, const Choice& choice, Suggestion* suggestion) {
  Place from = outlook.last_place();
  for (std::size_t i = 0; i < suggestion->stops.size(); ++i) {
    const Place to = Place::of(suggestion->stops[i].T_world_robot);
    if (!outlook.floor.may_drive(from, to))
      suggestion->notes.push_back(Finding("suggest.near_board", {{"stop", i + 1}}));
    from = to;
  }
  if (!choice.nothing_helps && suggestion->stops.size() < static_cast<std::size_t>(outlook.options.stops))
    suggestion->notes.push_back(Finding("suggest.few_places", {{"places", suggestion->stops.size()}}));
}

// What the method refuses has no figure.
AxisSigmas only_answered(const EstimatedTransform* transform, AxisSigmas sigmas) {
  for (std::size_t axis = 0; axis < 6; ++axis)
    if (transform == nullptr || !transform->observable[axis]) sigmas[axis].reset();
  return sigmas;
}

AxisSigmas stated_of(const Result& result, const std::string& robot, const std::string& camera,
                     suggest::Forecast::Errors errors = suggest::Forecast::Errors::kAll) {
  const EstimatedTransform* transform = result.find(robot, camera);
  AxisSigmas sigmas;
  if (transform == nullptr || !transform->covariance) return sigmas;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const Eigen::Index i = static_cast<Eigen::Index>(axis);
    const bool all = errors == suggest::Forecast::Errors::kAll;
    sigmas[axis] = std::sqrt(all ? (*transform->covariance)(i, i) : variance_beside_turning_point(*transform, axis));
  }
  return only_answered(transform, sigmas);
}

// Of the cameras that saw the board, as far as stops can change it.
std::vector<AxisSigmas> stated_now(const CalibrationSoFar& knowledge) {
  std::vector<AxisSigmas> stated;
  for (std::size_t c = 0; c < knowledge.has_pose.size(); ++c)
    if (knowledge.has_pose[c])
      stated.push_back(stated_of(knowledge.estimate.result, knowledge.basis.used.robot_frame,
                                 knowledge.basis.used.cameras[c].name, suggest::Forecast::Errors::kBesideTurningPoint));
  return stated;
}

// The stops, and the choice that led to them.
Choice choose_stops(const Outlook& outlook, Suggestion* suggestion) {
  const std::vector<Place> places = suggest::candidates_of(outlook);
  const std::vector<SuggestedStop> looking = looking_stops(outlook);
  std::vector<Place> first;
  for (const SuggestedStop& stop : looking) first.push_back(Place::of(stop.T_world_robot));
  const Place start = first.empty() ? outlook.last_place() : first.back();
  const Chooser chooser(outlook, suggestion->limits, stated_now(outlook.knowledge), places, first);
  Choice choice = chooser.completed({});
  while (true) {
    suggestion->stops = looking;
    const auto out_of_sight =
        command(outlook, places, in_driving_order(outlook, start, places, choice.places), &suggestion->stops);
    if (!out_of_sight) return choice;
    choice = chooser.completed(choice.without(*out_of_sight));
  }
}

// What `ml` makes of observations free of noise: whether the stops determine everything.
Result foreseen(const Outlook& outlook, const Observations& observations) {
  MlOptions options = outlook.options.ml;
  options.estimate_corner_level = options.estimate_plane_level = false;
  options.suspension_height_sigma_m = outlook.forecast.levels().suspension_height_m;
  options.suspension_tilt_sigma_rad = outlook.forecast.levels().suspension_tilt_rad;
  options.displacement_scale = outlook.forecast.levels().displacement_scale;
  return estimate_maximum_likelihood(observations, options).result;
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

void add_to_budget(const char* source, std::size_t axis, double variance, EstimatedTransform* camera) {
  if (!(variance > 0.0)) return;
  double& whole = (*camera->covariance)(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(axis));
  for (EstimatedTransform::Share& line : camera->budget) line.share[axis] *= whole / (whole + variance);
  whole += variance;
  camera->budget.push_back({source, {}});
  camera->budget.back().share[axis] = variance / whole;
}

// What is foretold has no ways between its stops, and with them nothing of where the robot turns, unless the rig says
// so.
Result with_turning_point(const CalibrationSoFar& knowledge, const Observations& foretold, Result then) {
  const OdometryModel model = knowledge.basis.levels.law.model;
  if (!ml::is_of_turning_point(model, knowledge.basis.used) || ml::is_of_turning_point(model, foretold)) return then;
  for (const ml::CommonError& error : ml::common_errors())
    for (EstimatedTransform& camera : then.camera_to_robot) {
      if (!error.along_way_only || !camera.covariance || camera.budget.empty()) continue;
      const double sigma_m = knowledge.estimate.noise.priors.*error.sigma_m;
      add_to_budget(error.source, static_cast<std::size_t>(error.axis), sigma_m * sigma_m, &camera);
    }
  return then;
}

// First among the notes.
void note_limits(const Result& then, double min_gain, Suggestion* suggestion) {
  std::vector<Finding> notes;
  if (suggestion->nothing_helps) notes.push_back(suggest::what_limits(then, *suggestion, min_gain));
  if (const auto measure = suggest::what_to_measure(then, *suggestion)) notes.push_back(*measure);
  suggestion->notes.insert(suggestion->notes.begin(), notes.begin(), notes.end());
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
  std::vector<const StopInformation*> stops;
  for (const StopInformation& stop : information) stops.push_back(&stop);
  add_cameras(outlook.knowledge, then, outlook.forecast.sigmas({}), outlook.forecast.sigmas(stops), suggestion);
  note_limits(with_turning_point(outlook.knowledge, observations, then), outlook.options.min_gain, suggestion);
}

}  // namespace

Suggestion suggest_stops(const Observations& observations, const SuggestOptions& options) {
  check(options);
  const AcceptLimits limits = observations.accept.value_or(options.limits);
  const CalibrationSoFar knowledge = suggest::calibration_so_far(observations, options.ml);
  const CalibrationState& state = knowledge.estimate.state;
  const Foresight foresight(knowledge, options);
  std::vector<suggest::Footprint> boards;
  for (const int board : foresight.boards())
    boards.push_back(suggest::footprint_of(knowledge.basis.used.board_at(board), suggest::pose_of_board(state, board)));
  const Outlook outlook{knowledge, options, Floor(options, state.T_world_robot, std::move(boards)), foresight,
                        Forecast(knowledge)};
  Suggestion suggestion;
  suggestion.limits = limits;
  suggestion.status_now = knowledge.estimate.result.status;
  suggestion.reasons_now = knowledge.estimate.result.reasons;
  suggestion.T_world_board = state.T_world_board;
  suggestion.T_world_robot = state.T_world_robot;
  const Choice choice = choose_stops(outlook, &suggestion);
  suggestion.nothing_helps = choice.nothing_helps;
  note_drive(outlook, choice, &suggestion);
  foretell(outlook, &suggestion);
  return suggestion;
}

}  // namespace rigproof
