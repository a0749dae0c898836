#include "rigproof/generator/drive.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr double kControlPeriod_s = 0.01;
constexpr double kTrajectoryPeriod_s = 0.01;
// Braking is planned with this share of what the wheels can do, so that the robot ends where it is to.
constexpr double kBrakeShare = 0.6;
// A turn accelerates within this time to its full rate.
constexpr double kTurnRise_s = 0.35;
constexpr double kTurnDone_rad = 0.002, kTurnDone_rad_s = 0.02;
constexpr double kWayDone_m = 0.002;
// Slower than this the wheels' stiction decides.
constexpr double kCreep_m_s = 0.02, kCreep_rad_s = 0.05;
// Line following: curvature from the heading error [rad/s per rad] and from the offset [1/m^2 times speed].
constexpr double kHeadingGain = 3.0, kOffsetGain = 4.0;
// Wheels at rest are held in their place by this [1/s]: the motors brake.
constexpr double kHoldGain = 10.0;
constexpr double kLookPeriod_s = 0.05;
constexpr double kTipped_rad = 0.6;
// Beyond the time that a piece of way takes with constant speed the robot is stuck.
constexpr double kPatience = 3.0, kPatience_s = 5.0;
constexpr int kMaxCorrections = 6;
// Another plan keeps away from a place of trouble by this.
constexpr double kAvoid_m = 0.7;
// Still enough to take images.
constexpr double kStill_m_s = 2e-4, kStill_rad_s = 5e-4;
constexpr double kMaxSettle_s = 10.0;
// The robot stands on after an image for this long.
constexpr double kAfterImage_s = 0.2;
// Share of the viewpoints that may be replaced, and how many at least.
constexpr double kReplaceable = 0.5;
constexpr std::size_t kReplaceableAtLeast = 10;

std::string place_text(const FloorPose& pose) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.2f m, %.2f m, %.0f deg)", pose.position.x(), pose.position.y(),
                rad_to_deg(pose.yaw_rad));
  return text;
}

// Stops at 0 from `rest` away with the given deceleration.
double braking_speed(double rest, double deceleration, double limit) {
  return std::copysign(std::min(limit, std::sqrt(2.0 * deceleration * std::abs(rest))), rest);
}

double at_least(double value, double least) { return std::copysign(std::max(std::abs(value), least), value); }

class Driver {
 public:
  Driver(DrivePhysics& physics, const DriveRequest& request)
      : physics_(physics),
        request_(request),
        config_(request.config),
        planner_(fresh_planner()),
        odometer_(request.wheels, 0.0, 0.0) {}

  Drive drive() {
    start();
    for (std::size_t i = 1; i < goals_.size(); ++i) {
      if (request_.progress && !request_.progress(drive_.reached.size()))
        throw Error("interrupted while driving; the same command starts the drive again", ExitCode::kTryAgain);
      visit(i);
    }
    drive_.duration_s = time_s();
    drive_.ways_tried_again = drive_.troubles.size();
    if (config_.capture == "moving") capture_along_the_way();
    return std::move(drive_);
  }

 private:
  // What a failed way is taken back to.
  struct Checkpoint {
    std::shared_ptr<const DrivePhysics::Snapshot> physics;
    std::int64_t steps;
    WheelOdometer odometer;
    std::size_t odometry_rows;
    double left_hold, right_hold;
  };

  RoutePlanner fresh_planner() const {
    return RoutePlanner(request_.area, [this](const FloorPose& pose) {
      for (const DriveTrouble& trouble : avoided_)
        if ((trouble.at.position - pose.position).norm() < kAvoid_m)
          return "the place where the robot " + trouble.reason;
      return physics_.obstacle(planar_pose(pose.position.x(), pose.position.y(), pose.yaw_rad), clearance_m_);
    });
  }

  double time_s() const { return static_cast<double>(steps_) * physics_.step_s(); }

  FloorPose pose() const {
    const Rigid3 T = physics_.T_world_robot();
    return {T.translation.head<2>(), yaw_of(T)};
  }

  void start() {
    goals_ = request_.goals;
    const FloorPose& first = goals_.front();
    const std::string obstacle =
        physics_.obstacle(planar_pose(first.position.x(), first.position.y(), first.yaw_rad), 0.0);
    if (!obstacle.empty()) throw Error(name_of(0) + " at " + place_text(first) + ": the robot would touch " + obstacle);
    physics_.place(first.position.x(), first.position.y(), first.yaw_rad);
    odometer_ = WheelOdometer(request_.wheels, physics_.left_wheels_rad(), physics_.right_wheels_rad());
    record();
    hold_wheels();
    if (!stand_and_capture(0)) refuse(0);
  }

  bool is_straight(std::size_t goal) const { return goal + request_.straight_goals >= goals_.size(); }

  std::string name_of(std::size_t goal) const {
    if (!is_straight(goal)) return "viewpoint " + std::to_string(goal + 1);
    return "frame " + std::to_string(goal + 1 + request_.straight_goals - goals_.size()) + " of the straight drive";
  }

  void visit(std::size_t goal) {
    const bool done = try_plans(goal);
    avoided_.clear();
    planner_ = fresh_planner();
    if (done) return;
    ++drive_.given_up;
    const std::size_t most = std::max(
        kReplaceableAtLeast, static_cast<std::size_t>(kReplaceable * static_cast<double>(request_.goals.size())));
    std::optional<FloorPose> other;
    if (request_.replacement && !is_straight(goal) && drive_.given_up <= most) other = request_.replacement();
    if (!other) refuse(goal);
    goals_.insert(goals_.end() - static_cast<std::ptrdiff_t>(request_.straight_goals), *other);
  }

  // Another plan avoids the place where the one before failed; where start or goal are too near to it, it takes the
  // next best way.
  bool try_plans(std::size_t goal) {
    const Checkpoint before = checkpoint();
    int number = 0;
    for (std::int64_t plan = 0; plan < config_.max_plans; ++plan) {
      const bool last = plan + 1 == config_.max_plans;
      // A way that keeps less distance is better than none.
      clearance_m_ = 0.01 * config_.clearance_cm / (last ? 3.0 : 1.0);
      if (plan > 0) planner_ = fresh_planner();
      if (reach(goal, number) && stand_and_capture(goal)) return true;
      const DriveTrouble& trouble = drive_.troubles.back();
      restore(before);
      if (no_way_) {
        avoided_.clear();
        plan = std::max(plan, config_.max_plans - 2);
      } else if ((trouble.at.position - pose().position).norm() > kAvoid_m &&
                 (trouble.at.position - goals_[goal].position).norm() > kAvoid_m) {
        avoided_.push_back(trouble);
      } else {
        ++number;
      }
    }
    return false;
  }

  [[noreturn]] void refuse(std::size_t goal) const {
    std::string text = name_of(goal) + " at " + place_text(goals_[goal]) + " cannot be reached:";
    bool lacks_way = false, fails_on_way = false;
    for (const DriveTrouble& trouble : drive_.troubles) {
      if (trouble.goal != goal) continue;
      text += " " + trouble.reason + " at " + place_text(trouble.at) + ";";
      (trouble.reason.rfind("no ", 0) == 0 ? lacks_way : fails_on_way) = true;
    }
    const std::string change =
        is_straight(goal) ? " change straight_drive.frames, the scene's straight_path," : " change viewpoints,";
    if (lacks_way || !fails_on_way) text += change + " drive.clearance_cm, or the place of the board";
    if (fails_on_way)
      text += std::string(lacks_way ? "," : change) +
              " or what it drives on and carries: drive.friction, unevenness_mm, ramps, payload_kg";
    if (drive_.given_up > 1) text += " (" + std::to_string(drive_.given_up) + " viewpoints were given up)";
    throw Error(text);
  }

  Checkpoint checkpoint() const {
    return {physics_.save(), steps_, odometer_, drive_.odometry.size(), left_hold_, right_hold_};
  }

  void restore(const Checkpoint& checkpoint) {
    physics_.restore(*checkpoint.physics);
    steps_ = looked_at_ = checkpoint.steps;
    odometer_ = checkpoint.odometer;
    drive_.odometry.resize(checkpoint.odometry_rows);
    drive_.trajectory.cut_after(time_s() + 0.5 * physics_.step_s());
    left_hold_ = checkpoint.left_hold;
    right_hold_ = checkpoint.right_hold;
    speed_ = turn_rate_ = 0.0;
  }

  // Drives there by the plan of this number; then corrects until the place is right.
  bool reach(std::size_t goal, int plan) {
    no_way_ = false;
    const FloorPose& target = goals_[goal];
    if (!follow(goal, plan, false)) return false;
    for (int i = 0; i < kMaxCorrections; ++i) {
      const FloorPose here = pose();
      const bool placed = (here.position - target.position).norm() <= 0.01 * config_.tolerance_cm;
      const double turn = wrap_angle(target.yaw_rad - here.yaw_rad);
      const bool headed = std::abs(turn) <= deg_to_rad(config_.tolerance_deg);
      if (placed && headed) return true;
      ++drive_.corrections;
      if (placed ? !turn_by(goal, turn) : !follow(goal, 0, true)) return false;
      stop();
    }
    return fail(goal, "stuck: ends too far from the viewpoint however often it corrects its place,");
  }

  bool follow(std::size_t goal, int plan, bool correct) {
    const std::optional<Route> route = planner_.route(pose(), goals_[goal], plan, correct);
    no_way_ = !route;
    if (!route)
      return fail(
          goal, "no " + std::string(plan > 0 ? "other " : "") + "way: " + planner_.last_obstacle() + " is in between,");
    for (const RouteLeg& leg : *route) {
      const bool done = leg.kind == RouteLeg::Kind::kTurn ? turn_to(goal, leg) : drive_to(goal, leg);
      if (!done) return false;
      stop();
    }
    return true;
  }

  bool fail(std::size_t goal, const std::string& reason) {
    drive_.troubles.push_back({goal, pose(), reason});
    return false;
  }

  // The planned turn may go the long way round; what slip has left over is added.
  bool turn_to(std::size_t goal, const RouteLeg& leg) {
    const double rest = wrap_angle(leg.end.yaw_rad - pose().yaw_rad);
    double turn = rest;
    if (std::abs(leg.turn_rad) > kPi && leg.turn_rad * rest < 0.0) turn += std::copysign(2.0 * kPi, leg.turn_rad);
    return turn_by(goal, turn);
  }

  bool turn_by(std::size_t goal, double turn_rad) {
    const double limit = deg_to_rad(config_.max_turn_deg_s), rise = limit / kTurnRise_s;
    const double deadline = time_s() + kPatience_s + kPatience * std::abs(turn_rad) / limit;
    double yaw = pose().yaw_rad, rest = turn_rad;
    while (std::abs(rest) > kTurnDone_rad || physics_.turn_rate_rad_s() > kTurnDone_rad_s) {
      if (time_s() > deadline) return fail(goal, "stuck: does not turn,");
      const bool there = std::abs(rest) <= kTurnDone_rad;
      if (!advance(0.0, there ? 0.0 : at_least(braking_speed(rest, kBrakeShare * rise, limit), kCreep_rad_s)))
        return fail(goal, trouble_);
      const double now = pose().yaw_rad;
      rest -= wrap_angle(now - yaw);
      yaw = now;
    }
    return true;
  }

  bool drive_to(std::size_t goal, const RouteLeg& leg) {
    const Eigen::Vector2d from = pose().position, way = leg.end.position - from;
    const double length = way.norm();
    if (length < kWayDone_m) return true;
    const Eigen::Vector2d along = way / length, left(-along.y(), along.x());
    const double heading = std::atan2(along.y(), along.x()) + (leg.backwards ? kPi : 0.0);
    const double direction = leg.backwards ? -1.0 : 1.0;
    const double deadline = time_s() + kPatience_s + kPatience * length / config_.max_speed_m_s;
    while (true) {
      const FloorPose here = pose();
      const double rest = length - (here.position - from).dot(along);
      if (rest < kWayDone_m) return true;
      if (time_s() > deadline) return fail(goal, "stuck: does not get on,");
      const double speed =
          at_least(braking_speed(rest, kBrakeShare * config_.acceleration_m_s2, config_.max_speed_m_s), kCreep_m_s);
      const double offset = (here.position - from).dot(left);
      const double turn = -kHeadingGain * wrap_angle(here.yaw_rad - heading) - kOffsetGain * speed * offset;
      if (!advance(direction * speed, turn)) return fail(goal, trouble_);
    }
  }

  // One period of control with accelerations limited. False, with trouble_, where the drive cannot go on.
  bool advance(double speed, double turn_rate) {
    const double dv = config_.acceleration_m_s2 * kControlPeriod_s;
    const double dw = deg_to_rad(config_.max_turn_deg_s) / kTurnRise_s * kControlPeriod_s;
    speed_ += std::clamp(speed - speed_, -dv, dv);
    turn_rate_ += std::clamp(turn_rate - turn_rate_, -dw, dw);
    const double difference = 0.5 * turn_rate_ * request_.wheels.effective_track_m;
    const double left = (speed_ - difference) / request_.wheels.wheel_radius_m;
    const double right = (speed_ + difference) / request_.wheels.wheel_radius_m;
    run(kControlPeriod_s, [&] { physics_.step(left, right); });
    return safe();
  }

  // Brakes and holds the wheels where they are.
  void stop() {
    speed_ = turn_rate_ = 0.0;
    hold_wheels();
    const double deadline = time_s() + kMaxSettle_s;
    while (time_s() < deadline && safe() &&
           (physics_.speed_m_s() > 50.0 * kStill_m_s || physics_.turn_rate_rad_s() > 50.0 * kStill_rad_s))
      stand(kControlPeriod_s);
  }

  void hold_wheels() {
    left_hold_ = physics_.left_wheels_rad();
    right_hold_ = physics_.right_wheels_rad();
  }

  void stand(double duration_s) {
    run(duration_s, [&] {
      physics_.step(kHoldGain * (left_hold_ - physics_.left_wheels_rad()),
                    kHoldGain * (right_hold_ - physics_.right_wheels_rad()));
    });
  }

  bool stand_and_capture(std::size_t goal) {
    hold_wheels();
    stand(config_.settle_s);
    const double deadline = time_s() + kMaxSettle_s;
    while (physics_.speed_m_s() > kStill_m_s || physics_.turn_rate_rad_s() > kStill_rad_s) {
      if (time_s() > deadline) return fail(goal, "does not come to rest");
      stand(kControlPeriod_s);
    }
    looked_at_ = -1000000;
    if (!safe()) return fail(goal, trouble_);
    const Capture capture{time_s(), physics_.T_world_robot()};
    const FloorPose here = pose();
    stand(kAfterImage_s);
    drive_.reached.push_back(goals_[goal]);
    drive_.captures.push_back(capture);
    drive_.worst_position_m = std::max(drive_.worst_position_m, (here.position - goals_[goal].position).norm());
    drive_.worst_heading_rad =
        std::max(drive_.worst_heading_rad, std::abs(wrap_angle(here.yaw_rad - goals_[goal].yaw_rad)));
    return true;
  }

  // Looks for a touch now and then: in between the robot goes on by less than ways keep clear.
  bool safe() {
    if (steps_ - looked_at_ < std::lround(kLookPeriod_s / physics_.step_s())) return true;
    looked_at_ = steps_;
    const std::string touched = physics_.touched();
    if (!touched.empty()) trouble_ = "touches " + touched;
    const bool tipped = physics_.tilt_rad() > kTipped_rad;
    if (tipped) trouble_ = "tipped over";
    return touched.empty() && !tipped;
  }

  template <typename Step>
  void run(double duration_s, const Step& step) {
    const auto count = static_cast<std::int64_t>(std::lround(duration_s / physics_.step_s()));
    for (std::int64_t i = 0; i < std::max<std::int64_t>(count, 1); ++i) {
      step();
      ++steps_;
      record();
    }
  }

  // True once a period, at the first step at or after its multiple.
  bool is_due(double period_s) const {
    const double step = physics_.step_s(), tolerance = 1e-6 * step;
    return steps_ == 0 ||
           std::floor((time_s() + tolerance) / period_s) > std::floor((time_s() - step + tolerance) / period_s);
  }

  void record() {
    if (is_due(1.0 / request_.odometry_rate_hz))
      drive_.odometry.push_back(odometer_.update(time_s(), physics_.left_wheels_rad(), physics_.right_wheels_rad()));
    if (is_due(kTrajectoryPeriod_s)) drive_.trajectory.add(time_s(), physics_.T_world_robot());
  }

  void capture_along_the_way() {
    drive_.captures.clear();
    const double period = 1.0 / config_.frame_rate_hz;
    for (std::int64_t i = 1; static_cast<double>(i) * period < drive_.duration_s; ++i) {
      const double stamp = static_cast<double>(i) * period;
      drive_.captures.push_back({stamp, drive_.trajectory.at(stamp)});
    }
  }

  DrivePhysics& physics_;
  const DriveRequest& request_;
  const DriveConfig& config_;
  double clearance_m_ = 0.05;
  RoutePlanner planner_;
  WheelOdometer odometer_;
  std::vector<FloorPose> goals_;
  std::vector<DriveTrouble> avoided_;  ///< on earlier ways to the present goal
  Drive drive_;
  std::int64_t steps_ = 0;
  std::int64_t looked_at_ = -1000000;     ///< step
  double speed_ = 0.0, turn_rate_ = 0.0;  ///< commanded
  double left_hold_ = 0.0, right_hold_ = 0.0;
  bool no_way_ = false;
  std::string trouble_;
};

}  // namespace

Drive simulate_drive(DrivePhysics& physics, const DriveRequest& request) {
  if (request.goals.empty()) throw Error("drive: there is no viewpoint to drive to");
  return Driver(physics, request).drive();
}

}  // namespace rigproof
