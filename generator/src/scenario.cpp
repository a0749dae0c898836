#include "scenario.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "board_height.h"
#include "drive_store.h"
#include "driven.h"
#include "exposures.h"
#include "lens_residual.h"
#include "rigproof/core/board_markers.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/core/text.h"
#include "rigproof/core/yaml.h"
#include "rigproof/generator/odometry.h"
#include "rigproof/generator/straight_drive.h"
#include "rigproof/sim/board_pattern.h"
#include "sensing/resolve.h"
#include "told_odometry.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

std::uint64_t seed_of(const GenerateConfig& config) { return static_cast<std::uint64_t>(config.seed); }

void choose_depth_frame(const GenerateConfig& config, const std::string& camera, const std::string& sensor,
                        DepthStream* depth) {
  if (config.depth_frame == "registered") depth->own_camera.reset();
  if (config.depth_frame != "raw" || depth->own_camera) return;
  if (!sensor.empty()) depth->own_camera = load_sensor_preset(sensor).raw_depth;
  if (!depth->own_camera)
    throw Error("depth_frame: raw: the sensor " + (sensor.empty() ? "(none)" : sensor) + " of camera " + camera +
                " does not say where it measures depth: depth.raw in its preset, or depth.camera and "
                "depth.T_color_depth in the rig " +
                config.rig);
}

// Intrinsics of the same camera with an image of `scale` times the size.
Camera scaled_camera(const Camera& camera, double scale) {
  if (scale == 1.0) return camera;
  Camera scaled = camera;
  scaled.width_px = std::max(16, static_cast<int>(std::lround(camera.width_px * scale)));
  scaled.height_px = std::max(16, static_cast<int>(std::lround(camera.height_px * scale)));
  // Rounded sizes stretch the image by a hair; the same factors keep the view exactly.
  const double sx = static_cast<double>(scaled.width_px) / camera.width_px;
  const double sy = static_cast<double>(scaled.height_px) / camera.height_px;
  scaled.fx_px = camera.fx_px * sx;
  scaled.fy_px = camera.fy_px * sy;
  scaled.cx_px = (camera.cx_px + 0.5) * sx - 0.5;
  scaled.cy_px = (camera.cy_px + 0.5) * sy - 0.5;
  return scaled;
}

// What is stated in pixels of the whole image is less in those of a smaller one.
IntrinsicsSigma scaled_sigma(IntrinsicsSigma sigma, double scale) {
  for (double* each_px : {&sigma.principal_point_px, &sigma.distortion_px, &sigma.residual_px}) *each_px *= scale;
  return sigma;
}

RigModel resolve_rig(const GenerateConfig& config) {
  RigModel rig = load_rig_model(config.rig);
  for (RigCamera& camera : rig.rig.cameras) {
    if (camera.depth) choose_depth_frame(config, camera.name, camera.sensor, &*camera.depth);
    if (camera.depth && camera.depth->own_camera)
      camera.depth->own_camera->camera = scaled_camera(camera.depth->own_camera->camera, config.image_scale);
    camera.camera = scaled_camera(camera.camera, config.image_scale);
    camera.intrinsics_sigma = scaled_sigma(camera.intrinsics_sigma, config.image_scale);
    if (camera.folder.empty()) camera.folder = camera.name;
  }
  return rig;
}

/// @param key of the board in the configuration
Board resolve_board(const BoardConfig& config, const std::string& key, const Board& of_rig) {
  Board board = config.preset.empty() ? of_rig : load_board(config.preset);
  if (!config.squares.empty()) {
    board.squares_x = static_cast<int>(config.squares[0]);
    board.squares_y = static_cast<int>(config.squares[1]);
  }
  if (config.square_mm > 0.0) board.square_m = config.square_mm / 1000.0;
  if (config.type != "preset") board.type = config.type;
  if (!config.dictionary.empty()) board.dictionary = config.dictionary;
  if (!config.dictionary.empty() && board.type != "charuco")
    throw Error(key + ".dictionary: " + config.dictionary + ": is of charuco boards; this one is of type " +
                board.type);
  if (board.type != "charuco") {
    const Board without;
    std::tie(board.dictionary, board.legacy_pattern) = std::tie(without.dictionary, without.legacy_pattern);
    if (!board.has_tags() || config.type != "preset") board.marker_m.reset();
  }
  if (const std::optional<std::string> problem = problem_of_markers(board))
    throw Error(key + (config.dictionary.empty() ? ".squares: " : ".dictionary: ") + *problem);
  if (board.type == "checkerboard" && board.ambiguous_under_half_turn()) {
    throw Error(key + ".squares: [" + std::to_string(board.squares_x) + ", " + std::to_string(board.squares_y) +
                "]: turned by 180 degrees this board looks the same, so that its corners cannot be told apart; use "
                "one even and one odd number");
  }
  return board;
}

// Throws Error where two of them would be taken for one another.
std::vector<Board> resolve_boards(const GenerateConfig& config, const Board& of_rig) {
  std::vector<Board> boards;
  for (std::size_t b = 0; b <= config.more_boards.size(); ++b) {
    const std::string key = key_of_board(b);
    boards.push_back(resolve_board(config.board_at(b), key, of_rig));
    for (std::size_t a = 0; a < b; ++a)
      if (const std::optional<std::string> problem = problem_of_telling_apart(boards[a], boards[b]))
        throw Error(key + ": cannot be told from " + key_of_board(a) + " in images: " + *problem);
  }
  return boards;
}

// The cameras as the rig has them, so that a board does not move with the size of the images.
std::vector<WorldCamera> unscaled_cameras(const GenerateConfig& config) {
  const RigModel rig = load_rig_model(config.rig);
  std::vector<WorldCamera> cameras;
  for (std::size_t i = 0; i < rig.rig.cameras.size(); ++i)
    cameras.push_back({rig.rig.cameras[i].name, rig.T_robot_camera[i], rig.rig.cameras[i].camera});
  return cameras;
}

BoardPlacement resolve_placement(const GenerateConfig& config, const SceneModel& scene, const WorldBoard& board,
                                 std::size_t index) {
  RandomStream random = stream_of_board(seed_of(config), "board", index);
  const BoardConfig& asked = config.board_at(index);
  const BoardPlacementRange given{asked.x_m, asked.y_m, asked.z_m, asked.facing_deg, asked.lean_deg, asked.roll_deg};
  const bool in_scene = index == 0 && asked.place != "given";
  const BoardPlacement placement = (in_scene ? scene.board : given).sample(random);
  return asked.place == "fitted"
             ? at_fitting_height(placement, unscaled_cameras(config), board.board, board.board_margin_m)
             : placement;
}

struct StandingBoard {
  WorldBoard board;
  std::map<std::string, double> drawn;  // for the truth, by field
};

StandingBoard stand_board(const GenerateConfig& config, const SceneModel& scene, const Board& board,
                          std::size_t index) {
  BoardDefectsDraw draw = draw_board_defects(config.board_at(index).defects, board, seed_of(config), index);
  StandingBoard standing;
  standing.board.board = board;
  standing.board.board_margin_m = draw.border_m;
  standing.board.board_defects = std::move(draw.defects);
  standing.board.T_world_board = place_board(board, resolve_placement(config, scene, standing.board, index));
  standing.drawn = std::move(draw.drawn);
  return standing;
}

ScenarioInput input_of(const fs::path& file) {
  const fs::path data = fs::weakly_canonical(data_folder());
  const fs::path relative = fs::weakly_canonical(file).lexically_relative(data);
  const bool inside = !relative.empty() && *relative.begin() != "..";
  return {inside ? relative.generic_string() : file.filename().string(), sha256_hex_of_file(file)};
}

// The presets' own files, and the boards, which presets may hold or the rig.
std::vector<ScenarioInput> inputs_of(const GenerateConfig& config, const RigModel& rig, const SceneModel& scene,
                                     const std::vector<Board>& boards) {
  std::vector<fs::path> files = {find_data_file("rigs", config.rig), rig.robot.file, rig.robot.mjcf,
                                 find_data_file("scenes", config.scene), scene.world.mjcf};
  for (const RigCamera& camera : rig.rig.cameras) {
    if (!camera.sensor.empty()) files.push_back(find_data_file("sensors", camera.sensor));
  }
  for (const SceneTexture& texture : scene.world.textures) {
    if (!texture.file.empty()) files.push_back(texture.file);
  }
  std::vector<ScenarioInput> inputs;
  for (const fs::path& file : files) inputs.push_back(input_of(file));
  for (std::size_t b = 0; b < boards.size(); ++b)
    inputs.push_back(
        {b == 0 ? "the board" : "board " + std::to_string(b + 1), sha256_hex(emit_yaml(tree_of(boards[b])))});
  // Two files outside of the data folder may share a name.
  const auto whole = [](const ScenarioInput& input) { return std::tie(input.name, input.sha256); };
  const auto before = [&](const ScenarioInput& a, const ScenarioInput& b) { return whole(a) < whole(b); };
  const auto same = [&](const ScenarioInput& a, const ScenarioInput& b) { return whole(a) == whole(b); };
  std::sort(inputs.begin(), inputs.end(), before);
  inputs.erase(std::unique(inputs.begin(), inputs.end(), same), inputs.end());
  return inputs;
}

// The robot's frame at the first stop, levelled to the scene's floor.
Rigid3 levelled(const Rigid3& T) { return planar_pose(T.translation.x(), T.translation.y(), yaw_of(T)); }

/// @param stamps_s of the stops
Truth true_part(const Scenario& scenario, const WorldDescription& description, const std::vector<double>& stamps_s) {
  const Rigid3 T_world_scene = levelled(scenario.T_scene_robot.front()).inverse();
  Truth truth;
  truth.scene = scenario.config.scene;
  truth.seed = seed_of(scenario.config);
  truth.board = description.board;
  truth.T_world_board = T_world_scene * description.T_world_board;
  for (const WorldBoard& board : description.more_boards)
    truth.more_boards.push_back({board.board, {}, T_world_scene * board.T_world_board});
  for (std::size_t i = 0; i < scenario.camera_count(); ++i) {
    const RigCamera& camera = scenario.rig.rig.cameras[i];
    TrueCamera entry{camera.name, scenario.rig.T_robot_camera[i], camera.camera, std::nullopt, {}};
    if (camera.depth) entry.depth_scale = scenario.sensors[i].depth_scale;
    if (camera.depth) entry.depth_camera = camera.depth->own_camera;
    entry.sensing = scenario.sensors[i].labels();
    truth.cameras.push_back(entry);
  }
  for (std::size_t i = 0; i < scenario.stop_count(); ++i)
    truth.stops.push_back({stamps_s[i], T_world_scene * scenario.T_scene_robot[i]});
  return truth;
}

std::string numbered(const std::string& folder, std::size_t number, const char* extension) {
  return fmt::format("{}/{:06}{}", folder, number, extension);
}

Recording recorded_part(const Scenario& scenario, const WorldDescription& description) {
  Recording recording;
  recording.rig = scenario.rig.rig;
  recording.rig.board = description.board;
  tell_board(scenario.config, 0, &recording.rig.board);
  recording.rig.more_boards.clear();
  for (const WorldBoard& board : description.more_boards) {
    recording.rig.more_boards.push_back(board.board);
    const std::size_t index = recording.rig.more_boards.size();
    Board& told = recording.rig.more_boards.back();
    tell_board(scenario.config, index, &told);
    told.place = told_place(scenario.config, index, description.T_world_board.inverse() * board.T_world_board);
  }
  for (std::size_t i = 0; i < recording.rig.cameras.size(); ++i) {
    tell_lens(scenario.config, static_cast<std::int32_t>(i), &recording.rig.cameras[i]);
    tell_readout(scenario.config, scenario.shutters[i].readout_s, &recording.rig.cameras[i]);
    tell_depth(scenario.config, &recording.rig.cameras[i]);
    tell_depth_bias(scenario.sensors[i], &recording.rig.cameras[i]);
  }
  const char* image_extension = scenario.sensor_images_are_jpeg() ? ".jpg" : ".png";
  const bool clouds = scenario.config.clouds == "pcd";
  for (const RigCamera& camera : recording.rig.cameras) {
    std::vector<CameraFrame>& frames = recording.frames.emplace_back();
    const std::vector<TrueStop>& stops = scenario.truth.stops_of(recording.frames.size() - 1);
    for (std::size_t i = 0; i < stops.size(); ++i) {
      CameraFrame frame;
      frame.color_file = numbered(camera.folder + "/color", i, image_extension);
      if (camera.depth) frame.depth_file = numbered(camera.folder + "/depth", i, ".png");
      if (camera.depth && clouds) frame.cloud_file = numbered(camera.folder + "/cloud", i, ".pcd");
      frame.stamp_s = stops[i].stamp_s;
      frame.exposure_s = scenario.shutters[recording.frames.size() - 1].exposure_s;
      frames.push_back(frame);
    }
  }
  if (scenario.plan.straight > 0) recording.segments = {straight_segment(scenario.truth.stops, scenario.plan.straight)};
  return recording;
}

// Stops exactly on the viewpoints, at equal times; the odometry is the truth with noise.
void teleport(const WorldDescription& description, const ViewpointSubject& subject, Scenario* scenario) {
  const GenerateConfig& config = scenario->config;
  ComposedViewpointWorld world(*scenario->world);
  scenario->plan = plan_viewpoints(config.viewpoints, config.poses, subject, world, seed_of(config));
  append_straight_stops(config.straight_drive, description.scene.straight_path, world, &scenario->plan);
  std::vector<double> stamps_s;
  for (const Viewpoint& stop : scenario->plan.stops) {
    stamps_s.push_back(static_cast<double>(stamps_s.size()) * config.stop_period_s);
    scenario->T_scene_robot.push_back(stop.T_scene_robot());
  }
  scenario->truth = true_part(*scenario, description, stamps_s);
  scenario->recording = recorded_part(*scenario, description);
  tell_odometry(config, scenario->rig.robot, &scenario->recording, &scenario->truth);
}

// The same drive, whether it is taken from a file or simulated.
DrivenViewpoints kept_or_simulated(const WorldDescription& description, const ViewpointSubject& subject,
                                   const DriveSource& source, const PhysicsOptions& physics, Scenario* scenario) {
  const std::string& key = scenario->drive_key = drive_key(scenario->config, scenario->inputs);
  std::vector<fs::path> files;
  if (!source.run.empty()) files.push_back(RunFolder{source.run}.drive_file());
  if (!source.cache.empty()) files.push_back(drive_in_cache(source.cache, key));
  std::optional<DrivenViewpoints> driven = find_drive(files, key);
  if (!driven)
    driven = drive_viewpoints(scenario->config, description, scenario->rig.robot, subject, *scenario->world, physics,
                              source.progress);
  scenario->drive_bytes = encode_drive(*driven, key);
  return std::move(*driven);
}

// Cameras without a common trigger in a robot that moves: each takes its images at times and places of its own.
void delay_cameras(Scenario* scenario) {
  const RobotTrajectory& trajectory = scenario->trajectory;
  Truth& truth = scenario->truth;
  const Rigid3 T_world_scene = levelled(scenario->T_scene_robot.front()).inverse();
  const std::vector<double> delays_s = rendered_delays_s(scenario->config, truth.cameras.size());
  for (std::size_t camera = 0; camera < delays_s.size(); ++camera) {
    TrueCamera& delayed = truth.cameras[camera];
    if (delays_s[camera] == 0.0) continue;
    for (const TrueStop& stop : truth.stops) {
      const double stamp_s = stop.stamp_s + delays_s[camera];
      if (stamp_s > trajectory.end_s()) break;  // nothing is recorded after the drive
      delayed.stops.push_back({stamp_s, T_world_scene * trajectory.at(stamp_s), trajectory.velocity(stamp_s)});
    }
    if (delayed.stops.empty())
      throw Error("sensing.time.camera_delay_ms: with " + number_text(1000.0 * delays_s[camera]) +
                  " ms the first image of camera " + delayed.name + " would be taken after the drive's end, at " +
                  number_text(trajectory.end_s()) +
                  " s: give a smaller one, more viewpoints, or a higher drive.frame_rate_hz");
    delayed.sensing["camera_delay_s"] = delays_s[camera];
  }
}

// The robot frame lies in the ground on which the robot stands; until here the truth has the one of its model, which
// leans on unequal wheels and under a load.
/// @param T_ground_robot how the model's frame stands: becomes Truth::T_robot_chassis
void lay_into_the_ground(const Rigid3& T_ground_robot, Truth* truth) {
  const Rigid3 T_robot_ground = T_ground_robot.inverse();
  const Rigid3 T_new_old = levelled(truth->stops.front().T_world_robot * T_robot_ground).inverse();  // of the world
  const auto lay = [&](TrueStop& stop) {
    stop.T_world_robot = T_new_old * stop.T_world_robot * T_robot_ground;
    if (!stop.velocity) return;
    const Eigen::Vector3d turning = T_ground_robot.rotation * stop.velocity->tail<3>();
    *stop.velocity << T_ground_robot.rotation * stop.velocity->head<3>() + T_ground_robot.translation.cross(turning),
        turning;
  };
  std::for_each(truth->stops.begin(), truth->stops.end(), lay);
  for (TrueCamera& camera : truth->cameras) {
    camera.T_robot_camera = T_ground_robot * camera.T_robot_camera;
    std::for_each(camera.stops.begin(), camera.stops.end(), lay);
  }
  truth->T_world_board = T_new_old * truth->T_world_board;
  for (TrueBoard& board : truth->more_boards) board.T_world_board = T_new_old * board.T_world_board;
  truth->T_robot_chassis = T_ground_robot;
}

// Stops where physics left the robot; the odometry is what its wheels counted.
void drive(const WorldDescription& description, const ViewpointSubject& subject, const DriveSource& source,
           Scenario* scenario) {
  const GenerateConfig& config = scenario->config;
  const DrivePhysicsDraw draw = draw_physics(config.drive, seed_of(config));
  DrivenViewpoints driven = kept_or_simulated(description, subject, source, draw.physics, scenario);
  scenario->plan = std::move(driven.plan);
  scenario->trajectory = std::move(driven.drive.trajectory);
  scenario->ways_tried_again = driven.drive.ways_tried_again;
  scenario->viewpoints_replaced = driven.drive.given_up;
  std::vector<double> stamps_s;
  for (const Capture& capture : driven.drive.captures) {
    stamps_s.push_back(capture.stamp_s);
    scenario->T_scene_robot.push_back(capture.T_scene_robot);
  }
  Truth& truth = scenario->truth;
  truth = true_part(*scenario, description, stamps_s);
  if (config.moves_while_exposing())
    for (TrueStop& stop : truth.stops) stop.velocity = scenario->trajectory.velocity(stop.stamp_s);
  delay_cameras(scenario);
  if (draw.physics.changes_stance()) lay_into_the_ground(driven.drive.T_ground_robot, &truth);
  label_odometry(driven.drive.odometry, &truth);
  truth.drawn.insert(draw.drawn.begin(), draw.drawn.end());
  scenario->recording = recorded_part(*scenario, description);
  scenario->recording.odometry = std::move(driven.drive.odometry);
  // Where wheels do not skid, their owner knows about which point they turn.
  if (scenario->rig.robot.slip_factor == 1.0) tell_driven_axle(&scenario->recording.rig);
}

/// @param drawn for the truth, by field
WorldDescription described_world(const GenerateConfig& config, const RigModel& rig, const SceneModel& scene,
                                 const std::vector<Board>& boards, std::map<std::string, double>* drawn) {
  WorldDescription description = describe_world(rig, scene, boards.front(), Rigid3(), seed_of(config));
  for (std::size_t b = 0; b < boards.size(); ++b) {
    StandingBoard standing = stand_board(config, scene, boards[b], b);
    drawn->merge(standing.drawn);
    if (b == 0)
      static_cast<WorldBoard&>(description) = std::move(standing.board);
    else
      description.more_boards.push_back(std::move(standing.board));
  }
  for (std::size_t i = 0; i < description.cameras.size(); ++i)
    description.cameras[i].lens_residual =
        drawn_lens_residual(config, rig.rig.cameras[i], static_cast<std::int32_t>(i));
  if (config.motion == "drive")
    description.ground = ground_of(config.drive, description.scene.drivable_area, seed_of(config));
  return description;
}

ViewpointSubject subject_of(const WorldDescription& description) {
  ViewpointSubject subject{{description.board, description.T_world_board, description.board_margin_m},
                           description.cameras};
  for (const WorldBoard& board : description.more_boards)
    subject.more_boards.push_back({board.board, board.T_world_board, board.board_margin_m});
  return subject;
}

std::vector<CameraCoverage> coverage_at_viewpoints(const Scenario& scenario) {
  ComposedViewpointWorld world(*scenario.world);
  return coverage_of(scenario.viewpoint_poses(), scenario.config.viewpoints, scenario.subject, world);
}

// A board that is not as told is not told to be exact.
void label_print(const WorldBoard& board, Board* told, TrueBoard* truth) {
  const BoardDefects& defects = board.board_defects;
  if (defects.print_scale_x != 1.0 || defects.print_scale_y != 1.0) told->square_sigma_m.reset();
  if (defects.bow_m != 0.0) told->bow_sigma_m.reset();
  if (defects.moves_corners()) truth->printed_corners = printed_corners(board.board, board.board_margin_m, defects);
}

// What boards and lenses show in every image alike.
void label_repeating_errors(const WorldDescription& description, Scenario* scenario) {
  Rig& told = scenario->recording.rig;
  label_print(description, &told.board, &scenario->truth);
  for (std::size_t b = 0; b < description.more_boards.size(); ++b)
    label_print(description.more_boards[b], &told.more_boards[b], &scenario->truth.more_boards[b]);
  for (std::size_t i = 0; i < description.cameras.size(); ++i) {
    const std::optional<LensResidual>& residual = description.cameras[i].lens_residual;
    if (!residual) continue;
    scenario->truth.cameras[i].lens_residual = residual;
    scenario->truth.cameras[i].sensing["lens_residual_px"] =
        lens_residual_rms_px(scenario->config, scenario->rig.rig.cameras[i]);
  }
}

// The frames that were not dropped, stop by stop. A camera's last stops may have none.
std::vector<FrameJob> recorded_frames(std::size_t stops, const std::vector<std::vector<CameraFrame>>& taken,
                                      const std::vector<std::vector<CameraFrame>>& recorded) {
  std::vector<FrameJob> jobs;
  std::vector<std::size_t> next(recorded.size(), 0);
  for (std::size_t stop = 0; stop < stops; ++stop) {
    for (std::size_t camera = 0; camera < recorded.size(); ++camera) {
      const std::size_t i = next[camera];
      if (i == recorded[camera].size() || recorded[camera][i].color_file != taken[camera][stop].color_file) continue;
      jobs.push_back({stop, camera, recorded[camera][i]});
      ++next[camera];
    }
  }
  return jobs;
}

}  // namespace

std::vector<ScenarioInput> scenario_inputs(const GenerateConfig& config) {
  const RigModel rig = load_rig_model(config.rig);
  const SceneModel scene = varied(load_scene_model(config.scene), config.randomize, seed_of(config));
  return inputs_of(config, rig, scene, resolve_boards(config, rig.rig.board));
}

Scenario resolve_scenario(const GenerateConfig& config, const DriveSource& source) {
  if (!config.scenes.empty())
    throw Error("scenes: this configuration makes " + std::to_string(config.scenes.size()) +
                " runs; `rigproof generate` makes them all, and --set scenes=[] --set scene=" + config.scenes.front() +
                " chooses one");
  Scenario scenario;
  scenario.config = config;
  scenario.rig = resolve_rig(config);
  const SceneModel scene = varied(load_scene_model(config.scene), config.randomize, seed_of(config));
  const std::vector<Board> boards = resolve_boards(config, scenario.rig.rig.board);
  scenario.inputs = inputs_of(config, scenario.rig, scene, boards);
  scenario.scene_text = scene_text(scene);
  scenario.sensors = resolve_sensors(config, scenario.rig.rig, scene.outdoor);
  scenario.shutters = resolve_shutters(config, scenario.rig.rig);
  std::map<std::string, double> drawn;
  const WorldDescription description = described_world(config, scenario.rig, scene, boards, &drawn);
  scenario.world = World::compose(description);
  scenario.subject = subject_of(description);
  const ViewpointSubject& subject = scenario.subject;
  if (config.motion == "drive")
    drive(description, subject, source, &scenario);
  else
    teleport(description, subject, &scenario);
  scenario.coverage = coverage_at_viewpoints(scenario);
  scenario.truth.drawn.insert(drawn.begin(), drawn.end());
  label_repeating_errors(description, &scenario);
  const std::vector<std::vector<CameraFrame>> taken = scenario.recording.frames;
  disturb_time(sensed_time(config), sensing_seed(config), &scenario.recording, &scenario.truth);
  scenario.frames = recorded_frames(scenario.stop_count(), taken, scenario.recording.frames);
  plan_exposures(&scenario);
  return scenario;
}

}  // namespace rigproof
