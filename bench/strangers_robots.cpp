#include "strangers_robots.h"

#include <array>
#include <vector>

#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/random.h"
#include "rigproof/core/text.h"

namespace rigproof::bench {
namespace {

struct World {
  const char* scene;
  bool has_daylight;  ///< in which time-of-flight cameras see hardly anything
};
constexpr std::array<World, 10> kWorlds = {{{"indoor_lab", false},
                                            {"corridor", false},
                                            {"home", false},
                                            {"office", false},
                                            {"warehouse", false},
                                            {"workshop", false},
                                            {"asphalt_lot", true},
                                            {"gravel", true},
                                            {"meadow", true},
                                            {"outdoor_yard", true}}};

// Where cameras can sit on a robot.
struct Body {
  const char* robot;
  double ahead_m, aside_m, lowest_m, highest_m;
  bool skids;
};
constexpr std::array<Body, 3> kBodies = {{{"husky", 0.28, 0.22, 0.5, 0.95, true},
                                          {"cart", 0.2, 0.18, 0.35, 0.95, false},
                                          {"turtlebot", 0.08, 0.1, 0.2, 0.45, false}}};

template <typename Values>
const auto& one_of(const Values& values, RandomStream* random) {
  return values[random->below(static_cast<std::uint32_t>(values.size()))];
}

std::string entry(const char* key, double value) { return std::string(key) + ": " + number_text(value); }

const char* draw_sensor(bool needs_depth, bool has_daylight, RandomStream* random) {
  static const std::vector<const char*> stereo = {"d415", "d435", "d455", "gemini_335", "oak_d", "zed_2i"},
                                        flight = {"azure_kinect", "l515"}, flat = {"fisheye", "industrial", "webcam"};
  const double kind = random->uniform();
  if (!needs_depth && kind < 0.3) return one_of(flat, random);
  return kind < 0.5 && !has_daylight ? one_of(flight, random) : one_of(stereo, random);
}

// The first camera looks ahead; of the others every third anywhere.
double draw_yaw_deg(int camera, RandomStream* random) {
  if (camera == 0) return random->uniform(-10.0, 10.0);
  return random->uniform() < 0.35 ? random->uniform(-180.0, 180.0) : random->uniform(-30.0, 30.0);
}

std::string with_cells(const std::string& sensor, int cells) { return sensor + "_" + std::to_string(cells); }

std::string camera_text(int camera, const Body& body, bool has_daylight, int cells, RandomStream* random) {
  const std::string sensor = with_cells(draw_sensor(camera == 0, has_daylight, random), cells);
  const double turn_deg = random->uniform() < 0.15 ? 90.0 : random->uniform() < 0.1 ? 175.0 : 0.0;
  return "  camera" + std::to_string(camera + 1) + ":\n    sensor: " + sensor + "\n    mount: {" +
         joined({entry("x_m", random->uniform(camera == 0 ? 0.0 : -body.ahead_m, body.ahead_m)),
                 entry("y_m", random->uniform(-body.aside_m, body.aside_m)),
                 entry("z_m", random->uniform(body.lowest_m, body.highest_m)),
                 entry("roll_deg", turn_deg + random->uniform(-4.0, 4.0)),
                 entry("pitch_deg", random->uniform(-2.0, 22.0)), entry("yaw_deg", draw_yaw_deg(camera, random))}) +
         "}\n";
}

// A load off its middle moves the point about which a robot on skidding wheels turns, by up to 13 cm here.
std::string load_text(std::uint64_t number, const Body& body) {
  if (!body.skids) return "";
  RandomStream random(number, "strangers' loads");
  return ", payload_kg: " + number_text(random.uniform(0.0, 15.0)) +
         ", payload_x_m: " + number_text(random.uniform(-0.25, 0.25)) +
         ", payload_y_m: " + number_text(random.uniform(-0.15, 0.15)) + ", payload_z_m: 0.4";
}

// One sigma: 1 % of the factors of wheels, 5 mm of the turning point, as their rigs say.
// Rigid carts of two wheels and two casters lose their wheels where the floor is uneven: theirs is flat.
std::string way_text(std::uint64_t number, const Body& body, RandomStream* random) {
  const std::string scale = number_text(random->normal(1.0, 0.01)), turns = number_text(random->normal(1.0, 0.01)),
                    turning_point_m = number_text(random->normal(0.0, 0.005));
  const double unevenness_mm = body.skids ? random->uniform(0.0, 2.0) : 0.0;
  switch (number % 3) {
    case 0:
      return "odometry: {model: per_increment, lambda: " + number_text(random->uniform(0.3, 2.0)) +
             ", scale: " + scale + ", yaw_factor: " + turns + ", rate_hz: 20}\n";
    case 1:
      return "odometry: {model: wheels, rate_hz: 50, wheels: {diameter_ratio: " +
             number_text(random->normal(1.0, 0.002)) + ", track_ratio: " + turns + ", icr_x_m: " + turning_point_m +
             ", slip_percent: " + number_text(random->uniform(0.1, 0.6)) + "}}\n";
    default:
      return "motion: drive\ndrive: {wheel_diameter_ratio: " + number_text(random->normal(1.0, 0.002)) +
             ", unevenness_mm: " + number_text(unevenness_mm) + load_text(number, body) + "}\n";
  }
}

}  // namespace

StrangersRobot strangers_robot(std::uint64_t number, int stops, double image_scale) {
  static const std::vector<const char*> boards = {"checkerboard_5x4_100mm", "checkerboard_6x5_110mm",
                                                  "charuco_7x5_100mm", "aprilgrid_6x4_130mm"};
  RandomStream random(number, "strangers' robots");
  const World& world = kWorlds[number % kWorlds.size()];
  const Body& body = one_of(kBodies, &random);
  const char* board = one_of(boards, &random);
  const int cameras = 1 + static_cast<int>(random.below(4));
  StrangersRobot made;
  made.rig = std::string("robot: ") + body.robot + "\nboard: " + board + "\ncameras:\n";
  const int cells = kLensCells[number / kWorlds.size() % kLensCells.size()];
  for (int camera = 0; camera < cameras; ++camera)
    made.rig += camera_text(camera, body, world.has_daylight, cells, &random);
  made.run = std::string("include: realistic\nscene: ") + world.scene + "\nseed: " + std::to_string(number) +
             "\nposes: " + std::to_string(stops) + "\nimage_scale: " + number_text(image_scale) + "\n" +
             way_text(number, body, &random);
  const std::array<const char*, 3> ways = {"increments", "wheels", "driven"};
  made.summary = std::string(body.robot) + " in " + world.scene + ", " + ways[number % ways.size()] + ", " +
                 std::to_string(cameras) + " cameras, fields of " + std::to_string(cells) + " cells, " + board;
  return made;
}

void write_sensors(const std::filesystem::path& folder) {
  const std::string where = "\n  color:";
  const std::filesystem::path shipped = data_folder() / "models" / "sensors", made = folder / "models" / "sensors";
  std::filesystem::create_directories(made);
  for (const auto& entry : std::filesystem::directory_iterator(shipped)) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string text = read_text_file(entry.path()) + "\n";
    const std::size_t simulation = text.find("\nsimulation:"), color = text.find(where, simulation);
    if (color == std::string::npos) throw Error(entry.path().string() + ": simulates no colour");
    const std::size_t end = text.find('\n', color + 1);
    for (const int cells : kLensCells)
      write_file_atomically_unsynced(
          made / (with_cells(entry.path().stem().string(), cells) + ".yaml"),
          text.substr(0, end) + "\n    lens_residual_cells: " + std::to_string(cells) + text.substr(end));
  }
}

}  // namespace rigproof::bench
