#include <algorithm>
#include <chrono>

#include "measured_noise.h"
#include "rigproof/calib/plan/accept.h"
#include "rigproof/calib/vision/ground_source.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/generator/plan_run.h"
#include "work.h"

namespace rigproof {
namespace {

using Clock = std::chrono::steady_clock;

// The recording as if the drive had ended after so many stops. Frames of segments, which are none, stay.
void keep_first_stops(std::int64_t count, const Truth& truth, Recording* recording) {
  std::vector<double> stamps;
  for (const TrueStop& stop : truth.stops) {
    CameraFrame frame;
    frame.stamp_s = stop.stamp_s;
    if (!recording->in_segment(frame)) stamps.push_back(stop.stamp_s);
  }
  const auto wanted = static_cast<std::size_t>(count);
  if (wanted > stamps.size())
    throw Error("images: " + std::to_string(count) + ": the drive has " + std::to_string(stamps.size()) + " stops");
  if (wanted == stamps.size()) return;
  // Clocks may be off by less than half of the time between stops.
  const double end_s = 0.5 * (stamps[wanted - 1] + stamps[wanted]);
  for (std::vector<CameraFrame>& frames : recording->frames)
    frames.erase(std::remove_if(
                     frames.begin(), frames.end(),
                     [&](const CameraFrame& frame) { return frame.stamp_s > end_s && !recording->in_segment(frame); }),
                 frames.end());
}

void keep_first_stops(std::int64_t count, Observations* observations) {
  const auto wanted = static_cast<std::size_t>(count);
  if (wanted > observations->stops.size())
    throw Error("images: " + std::to_string(count) + ": the drive has " + std::to_string(observations->stops.size()) +
                " stops");
  *observations = stops_of(*observations, 0, static_cast<int>(count));
}

// Pictures come from the cache, and what was found in them; the odometry is this task's.
TaskData rendered_data(const std::string& pictures, const TaskSettings& task, const SweepCache& cache,
                       const Count& count, const std::function<bool()>& keep_going) {
  const RunFolder run = cache.pictures(pictures);
  if (!cache.has_pictures(pictures, false)) {
    plan_run(task.config);  // throws what make_pictures() passed over
    throw MachineError(run.root.string() + ": pictures are missing; the same command makes them", ExitCode::kTryAgain);
  }
  TaskData data;
  data.truth = load_truth(run.truth_file());
  data.recording = load_recording_of(run);
  if (odometry_is_apart(task.config)) replace_odometry(task.config, &*data.recording, &data.truth);
  if (task.images > 0) keep_first_stops(task.images, data.truth, &*data.recording);
  data.findings = std::make_shared<CachedFindings>(cache, run);
  CachedFindings& findings = *data.findings;
  data.gl_renderer = findings.gl_renderer();
  ObserveOptions options;
  options.threads = 1;
  options.progress = [&keep_going](std::size_t, std::size_t) { return !keep_going || keep_going(); };
  try {
    data.observations = observe(*data.recording, options, &findings);
  } catch (const Error&) {
    findings.tell(count);
    findings.rethrow();
    throw;
  }
  findings.tell(count);
  if (!findings.unanswered().empty()) {
    cache.forget_observed(pictures);
    throw MachineError(run.root.string() +
                           ": the cache lost what was found in its pictures; the same command makes "
                           "it again",
                       ExitCode::kTryAgain);
  }
  data.observations.source.clear();  // names the cache's folder
  findings.rethrow();
  return data;
}

GeometricDrive drive_named(const std::string& name) {
  static const std::map<std::string, GeometricDrive> drives = {
      {"random", GeometricDrive::kRandom},     {"steps", GeometricDrive::kSteps},
      {"straight", GeometricDrive::kStraight}, {"turn_in_place", GeometricDrive::kTurnInPlace},
      {"arc", GeometricDrive::kArc},           {"standstill", GeometricDrive::kStandstill}};
  return drives.at(name);
}

// Everything but rig, drive and odometry.
GeometricConfig noise_of(const GeometricSweepConfig& block, std::uint64_t seed) {
  GeometricConfig config;
  config.seed = seed;
  config.corner_sigma_px = block.corner_sigma_px;
  config.ground = block.ground;
  config.board_planes = block.board_planes;
  config.inverse_depth_sigma_per_m = block.inverse_depth_sigma_per_m;
  config.ground_points = block.ground_points;
  config.board_points = block.board_points;
  config.depth_scale_sigma = block.depth_scale_sigma;
  config.suspension_height_sigma_m = block.suspension_height_sigma_mm / 1000.0;
  config.suspension_tilt_sigma_rad = deg_to_rad(block.suspension_tilt_sigma_deg);
  config.corner_outlier_fraction = block.corner_outlier_fraction;
  config.odometry_outlier_fraction = block.odometry_outlier_fraction;
  config.plane_outlier_fraction = block.plane_outlier_fraction;
  return config;
}

TaskData drawn_data(const TaskSettings& task) {
  const auto seed = static_cast<std::uint64_t>(task.config.seed);
  const OdometryConfig& odometry = task.config.odometry;
  GeometricConfig config = noise_of(task.geometric, seed);
  if (task.geometric.rig == "random") config.rig = random_rig(seed, static_cast<int>(task.geometric.cameras));
  config.drive = drive_named(task.geometric.drive);
  config.stops = static_cast<int>(task.config.poses);
  config.odometry_model = odometry.model == "per_pose" ? OdometryModel::kPerPose : OdometryModel::kPerIncrement;
  config.lambda = odometry.lambda;
  RandomStream random(seed, "odometry systematics");
  config.odometry_scale = odometry.scale.sample(random);
  config.odometry_yaw_factor = odometry.yaw_factor.sample(random);
  config.declare_odometry_model = config.declare_odometry_sigmas = odometry.declared;
  const GeometricScene scene = draw_scene(config);
  if (odometry.seed >= 0) config.seed = static_cast<std::uint64_t>(odometry.seed);
  GeometricRun run = draw_geometric_run(config, scene);
  TaskData data;
  data.observations = std::move(run.observations);
  data.truth = std::move(run.truth);
  return data;
}

std::size_t sample_at(const std::vector<OdometrySample>& odometry, double stamp_s) {
  const auto nearer = [stamp_s](const OdometrySample& a, const OdometrySample& b) {
    return std::abs(a.stamp_s - stamp_s) < std::abs(b.stamp_s - stamp_s);
  };
  return static_cast<std::size_t>(std::min_element(odometry.begin(), odometry.end(), nearer) - odometry.begin());
}

BoardDefectsConfig as_printed() {
  BoardDefectsConfig defects;
  defects.bow_mm = defects.print_error_mm = 0.0;
  return defects;
}

// Rig, stops and odometry as the run plans them; corners and planes drawn.
TaskData planned_data(const TaskSettings& task) {
  GenerateConfig planned = task.config;
  // Corners and planes are drawn through the lenses, and on the boards, that are told.
  planned.sensing.told = "exact";
  planned.render.lens_residual = false;
  planned.board.defects = as_printed();
  for (BoardConfig& board : planned.more_boards) board.defects = as_printed();
  PlannedRun plan = plan_run(planned);
  const std::int64_t seed = task.config.sensing.seed >= 0 ? task.config.sensing.seed : task.config.seed;
  GeometricConfig config = noise_of(task.geometric, static_cast<std::uint64_t>(seed));
  config.rig.cameras = plan.recording.rig.cameras;
  if (!task.geometric.measured.empty()) config.measured = measured_noise(task.geometric.measured, config.rig.cameras);
  for (const TrueCamera& camera : plan.truth.cameras) config.depth_scales.push_back(camera.depth_scale.value_or(1.0));
  config.rig.T_robot_camera.clear();
  for (const TrueCamera& camera : plan.truth.cameras) config.rig.T_robot_camera.push_back(camera.T_robot_camera);
  config.rig.board = plan.recording.rig.board;
  GeometricScene scene;
  scene.T_world_board = plan.truth.T_world_board;
  for (int b = 1; b < plan.truth.boards(); ++b)
    scene.more_boards.push_back({plan.recording.rig.board_at(b), plan.truth.board_at(b).T_world_board, {}});
  std::vector<TrueStop> stops;
  for (const TrueStop& stop : plan.truth.stops) {
    CameraFrame frame;
    frame.stamp_s = stop.stamp_s;
    if (plan.recording.in_segment(frame)) continue;
    stops.push_back(stop);
    scene.T_world_robot.push_back(stop.T_world_robot);
  }
  config.stops = static_cast<int>(stops.size());
  GeometricRun run = draw_geometric_run(config, scene);
  TaskData data;
  data.observations = std::move(run.observations);
  data.observations.odometry_noise = plan.recording.rig.odometry_noise;
  data.observations.robot_frame = plan.recording.rig.robot_frame;
  const std::vector<OdometrySample> odometry = odometry_of_origin(plan.recording);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const OdometrySample& sample = odometry[sample_at(odometry, stops[i].stamp_s)];
    data.observations.stops[i] = {stops[i].stamp_s, sample.x_m, sample.y_m, sample.yaw_rad, 0.0};
  }
  for (BoardView& view : data.observations.board_views)
    view.stamp_s = stops[static_cast<std::size_t>(view.stop)].stamp_s;
  data.truth = std::move(plan.truth);
  data.truth.stops = std::move(stops);
  return data;
}

}  // namespace

SweepSight::SweepSight(const SweepVision& vision) {
  if (vision.features != SweepVision().features) features = feature_source_by_name(vision.features);
  if (!vision.horizon.empty()) horizon = horizon_source_by_name(vision.horizon);
}

TaskData with_ground(const TaskData& data, const std::string& ground, const SweepSight& sight) {
  const GroundSource source = ground_source_by_name(ground);
  TaskData other = data;
  if (!other.recording) return other;
  MethodInput input{data.observations, &*other.recording, 1, sight.features.get()};
  input.memory = other.findings.get();
  input.keep_going = data.keep_going;
  for (const int camera : take_ground_from(source, input, &other.observations).cameras) {
    const std::string& name = other.observations.cameras[static_cast<std::size_t>(camera)].name;
    for (TrueCamera& truth : other.truth.cameras)
      if (truth.name == name) truth.depth_scale.reset();  // what is triangulated has the board's scale
  }
  other.bounds = transform_bounds(other.observations, other.truth);
  return other;
}

TaskData data_of(const SweepConfig& config, const SweepTask& task, const SweepCache& cache, const Count& count,
                 const std::function<bool()>& keep_going) {
  const auto start = Clock::now();
  const TaskSettings settings = settings_of(config, task);
  TaskData data;
  if (!task.pictures.empty()) {
    data = rendered_data(task.pictures, settings, cache, count, keep_going);
  } else {
    data = settings.geometric.rig == "run" ? planned_data(settings) : drawn_data(settings);
    if (settings.images > 0) keep_first_stops(settings.images, &data.observations);
  }
  data.keep_going = keep_going;
  data.bounds = transform_bounds(data.observations, data.truth);
  data.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  count("observations made", 1);
  return data;
}

}  // namespace rigproof
