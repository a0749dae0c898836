// The drive alone, without pictures.
//
//   bench_drive track                        effective track over track of every robot, over speed and turn rate, and
//                                            how many times faster than real time the physics is (CPU time)
//   bench_drive scenes [POSES=100] [key: value ..]   a drive through POSES viewpoints in every scene: the table of
//                                            docs/measurements/driving.md, and what the odometry makes of it
//
// Further arguments of `scenes` are lines of a run's configuration, e.g. "scene: indoor_lab" or "seed: 3".
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "clocks.h"
#include "driven.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/sim/models.h"
#include "rigproof/study/workflow/scratch_folder.h"
#include "scenario.h"

namespace {

namespace fs = std::filesystem;
using namespace rigproof;

// Nothing but a floor.
SceneModel empty_scene(const fs::path& folder) {
  std::ofstream(folder / "empty.xml") << "<mujoco><worldbody><geom name=\"floor\" type=\"plane\" size=\"99 99 1\"/>"
                                         "</worldbody></mujoco>\n";
  std::ofstream(folder / "empty.yaml")
      << "mjcf: empty.xml\ndrivable_area: {x_min_m: -50, x_max_m: 50, y_min_m: -50, y_max_m: 50}\n"
         "board: {x_m: 40, y_m: 0, z_m: 1, facing_deg: 180, lean_deg: 0, roll_deg: 0}\n";
  return load_scene_model((folder / "empty.yaml").string());
}

// Wheel speeds over the yaw rate that they give, in tracks.
double track_factor(DrivePhysics& physics, const RobotModel& robot, double speed, double rate) {
  constexpr double kStart_s = 1.0, kWait_s = 2.0, kTime_s = 8.0;
  physics.place(0.0, 0.0, 0.0);
  const double half = 0.5 * rate * robot.track_m * robot.slip_factor;
  double left = 0.0, right = 0.0, turned = 0.0, yaw = 0.0;
  bool measures = false;
  while (physics.time_s() < kTime_s) {
    const double ramp = std::min(1.0, physics.time_s() / kStart_s);
    physics.step(ramp * (speed - half) / robot.wheel_radius_m, ramp * (speed + half) / robot.wheel_radius_m);
    const double now = yaw_of(physics.T_world_robot());
    if (measures) turned += wrap_angle(now - yaw);
    yaw = now;
    if (measures || physics.time_s() < kWait_s) continue;
    measures = true;
    left = physics.left_wheels_rad();
    right = physics.right_wheels_rad();
  }
  return robot.wheel_radius_m * (physics.right_wheels_rad() - right - physics.left_wheels_rad() + left) /
         (robot.track_m * turned);
}

void track(const fs::path& folder) {
  const SceneModel scene = empty_scene(folder);
  for (const std::string& rig_name : {std::string("husky_3x_d455"), std::string("cart_5x_mixed")}) {
    const RigModel rig = load_rig_model(rig_name);
    DrivePhysics physics(describe_world(rig, scene, rig.rig.board, place_board(rig.rig.board, scene.board.middle()), 0),
                         {});
    std::printf("%s: effective track / track, nominal %.3f\n v [m/s]  omega [rad/s]: 0.3   0.5   0.75  1.0\n",
                rig.robot.name.c_str(), rig.robot.slip_factor);
    const double before = cpu_s();
    int drives = 0;
    for (const double speed : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      std::printf(" %.2f                 ", speed);
      for (const double rate : {0.3, 0.5, 0.75, 1.0}) {
        std::printf(" %.3f", track_factor(physics, rig.robot, speed, rate));
        ++drives;
      }
      std::printf("\n");
    }
    std::printf(" %.0f times real time\n", 8.0 * drives / (cpu_s() - before));
  }
}

// How far from the plan the robot stood, at worst.
struct Worst {
  double position_m = 0.0, heading_rad = 0.0;
};
Worst worst_of(const Scenario& scenario) {
  Worst worst;
  if (scenario.plan.stops.size() != scenario.stop_count()) return worst;  // capture: moving
  for (std::size_t i = 0; i < scenario.stop_count(); ++i) {
    const Rigid3 planned = scenario.plan.stops[i].T_scene_robot(), &real = scenario.T_scene_robot[i];
    worst.position_m = std::max(worst.position_m, (planned.translation - real.translation).head<2>().norm());
    worst.heading_rad = std::max(worst.heading_rad, std::abs(wrap_angle(yaw_of(planned) - yaw_of(real))));
  }
  return worst;
}

// Poses of the way on which the robot touches something, twenty a second looked at.
std::size_t touches_of(const Scenario& scenario) {
  constexpr std::size_t kEvery = 5;
  const DrivePhysics physics(scenario.world->description(), {});
  const std::vector<Rigid3>& poses = scenario.trajectory.poses();
  std::size_t touches = 0;
  for (std::size_t i = 0; i < poses.size(); i += kEvery)
    if (!physics.obstacle(poses[i], 0.0).empty()) ++touches;
  return touches;
}

void print_head() {
  std::printf(
      "| world | viewpoints | worst place [cm] | worst heading [deg] | touches | ways tried again | replaced | way [m] "
      "| "
      "drive [s] | CPU [s] | times real time | odometry: yaw factor | left over a stop [cm, deg] |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

// CPU time with planning and loading.
void drive_scene(const std::string& scene, int poses, const std::string& more) {
  const double before = cpu_s();
  try {
    GenerateConfig config = parse_generate_config("motion: drive\nscene: " + scene + "\n" + more, "arguments");
    config.poses = poses;
    const Scenario scenario = resolve_scenario(config);
    const double cpu = cpu_s() - before, drive_s = scenario.trajectory.end_s();
    const Worst worst = worst_of(scenario);
    std::printf("| `%s` | %zu | %.2f | %.2f | %zu | %zu | %zu | %.0f | %.0f | %.1f | %.0f | %.3f | %.1f, %.2f |\n",
                scene.c_str(), scenario.stop_count(), 100.0 * worst.position_m, rad_to_deg(worst.heading_rad),
                touches_of(scenario), scenario.ways_tried_again, scenario.viewpoints_replaced,
                scenario.trajectory.length_m(), drive_s, cpu, drive_s / cpu, scenario.truth.odometry_yaw_factor,
                100.0 * *scenario.truth.odometry_noise.sigma_xy_m,
                rad_to_deg(*scenario.truth.odometry_noise.sigma_yaw_rad));
  } catch (const Error& error) {
    std::printf("| `%s` | %s |\n", scene.c_str(), error.what());
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::string what = "track", more;
  int poses = 100;
  std::vector<std::string> scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.rfind("scene: ", 0) == 0)
      scenes.push_back(argument.substr(7));
    else if (argument.find(':') != std::string::npos)
      more += argument + "\n";
    else if (std::isdigit(static_cast<unsigned char>(argument[0])))
      poses = std::stoi(argument);
    else
      what = argument;
  }
  try {
    if (what == "track") track(ScratchFolder("bench-drive").path());
    if (what == "scenes") print_head();
    if (what == "scenes")
      for (const std::string& scene : scenes.empty() ? scene_model_names() : scenes) drive_scene(scene, poses, more);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
