#include "rigproof/study/report/check_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/vision/ground_plane.h"
#include "rigproof/calib/vision/image_io.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/generate.h"
#include "rigproof/generator/viewpoints.h"
#include "rigproof/sim/models.h"
#include "rigproof/study/workflow/scratch_folder.h"
#include "rigproof/truth/truth.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRig = "husky_3x_d455";
constexpr double kNormalLimitDeg = 1.0, kHeightLimitMm = 5.0, kScaleSigma = 0.003;
constexpr double kBoardWholeLimit = 0.9;
// Lower than this is floor, noise aside.
constexpr double kFloorM = 0.02;
constexpr int kDepthStride = 9;
// Heights of a rig's cameras above the floor differ less than half a metre from this: the scale error's share of it.
constexpr double kTypicalHeightM = 0.7;

GenerateConfig config_of(const std::string& scene, const SceneModel& model, int poses) {
  GenerateConfig config;
  config.name = model.name;
  config.scene = scene;
  config.rig = kRig;
  config.poses = poses;
  config.board.place = "scene";
  config.viewpoints.planner = "sampled";  // what cameras that look ahead see of the scene
  if (model.world.straight_path.length_m > 0.0) config.straight_drive.frames = 3;
  return config;
}

Image8 read_rgb(const fs::path& file) {
  const cv::Mat bgr = cv::imread(file.string(), cv::IMREAD_COLOR);
  if (bgr.empty()) throw Error(file.string() + ": cannot be read");
  Image8 image(bgr.cols, bgr.rows, 3);
  cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, image.pixels.data());
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return image;
}

// What a plan of many stops would show, without rendering.
void plan_many(const std::string& scene_name, const SceneModel& scene, int poses, SceneCheck* check) {
  const GenerateConfig config = config_of(scene_name, scene, poses);
  const RigModel rig = load_rig_model(kRig);
  const Rigid3 T_scene_board = place_board(rig.rig.board, scene.board.middle());
  const WorldDescription description = describe_world(rig, scene, rig.rig.board, T_scene_board, 0);
  const auto world = World::compose(description);
  ComposedViewpointWorld viewpoint_world(*world);
  const ViewpointSubject subject{{rig.rig.board, T_scene_board, description.board_margin_m}, description.cameras};
  const ViewpointPlan plan = plan_viewpoints(config.viewpoints, poses, subject, viewpoint_world, 0);
  int whole = 0;
  check->planned_board_everywhere = true;
  for (const Viewpoint& stop : plan.stops) {
    whole += stop.cameras_with_board;
    check->planned_board_everywhere = check->planned_board_everywhere && stop.cameras_with_board > 0;
  }
  check->planned_whole_share =
      static_cast<double>(whole) / static_cast<double>(plan.stops.size() * rig.rig.cameras.size());
}

// A generated run, read as any other.
class Measurement {
 public:
  Measurement(const RunFolder& run, int threads)
      : recording_(load_recording(run.recording())), truth_(load_truth(run.truth_file())) {
    ObserveOptions options;
    options.threads = threads;
    observations_ = observe(recording_, options);
  }

  void measure(SceneCheck* check) const {
    count_boards(check);
    measure_grounds(check);
    measure_floor_shares(check);
    count_keypoints(check);
    take_pictures(check);
  }

 private:
  Rigid3 T_world_camera(std::size_t stop, std::size_t camera) const {
    return truth_.stops.at(stop).T_world_robot * truth_.cameras.at(camera).T_robot_camera;
  }

  // Frames of the viewpoints come first, one a stop.
  std::size_t viewpoint_count() const { return observations_.stops.size(); }

  bool whole_board(std::size_t stop, std::size_t camera) const {
    const Rigid3 T_camera_board = T_world_camera(stop, camera).inverse() * truth_.T_world_board;
    const Camera& lens = truth_.cameras[camera].camera;
    const std::vector<Eigen::Vector3d> outline = truth_.board.outline();
    return std::all_of(outline.begin(), outline.end(), [&](const Eigen::Vector3d& corner) {
      Eigen::Vector2d pixel;
      return lens.project(T_camera_board * corner, &pixel) && lens.contains(pixel);
    });
  }

  void count_boards(SceneCheck* check) const {
    for (std::size_t camera = 0; camera < truth_.cameras.size(); ++camera)
      for (std::size_t stop = 0; stop < viewpoint_count(); ++stop) {
        ++check->images;
        check->boards_visible += whole_board(stop, camera);
      }
    check->boards_found = observations_.board_views.size();
  }

  void measure_grounds(SceneCheck* check) const {
    check->depth_images = check->images;
    check->grounds_found = observations_.ground_planes.size();
    for (const PlaneObservation& plane : observations_.ground_planes) {
      const Rigid3 T = T_world_camera(static_cast<std::size_t>(plane.stop), static_cast<std::size_t>(plane.camera));
      check->worst_normal_deg = std::max(check->worst_normal_deg, lean_deg(plane, T));
      const double error_m = height_above(plane).height_m - T.translation.z();
      check->worst_height_mm = std::max(check->worst_height_mm, 1000.0 * std::abs(error_m));
    }
  }

  // Angle between a plane's normal, pointing to the camera's side, and the vertical.
  static double lean_deg(const PlaneObservation& plane, const Rigid3& T_world_camera) {
    const Eigen::Vector3d up = -(T_world_camera.rotation * plane.inverse_depth_plane.normalized());
    return rad_to_deg(std::acos(std::clamp(up.z(), -1.0, 1.0)));
  }

  // What else than floor is there to be taken for ground.
  void measure_floor_shares(SceneCheck* check) const {
    for (std::size_t camera = 0; camera < recording_.frames.size(); ++camera) {
      const RigCamera& rig_camera = recording_.rig.cameras[camera];
      for (std::size_t stop = 0; stop < viewpoint_count(); ++stop) {
        const auto depth = read_depth_image(recording_.folder / recording_.frames[camera][stop].depth_file);
        if (!std::holds_alternative<Image16>(depth)) continue;
        const DepthPoints points = points_from_depth(std::get<Image16>(depth), rig_camera, kDepthStride);
        const double share = floor_share(points, rig_camera.depth->noise, T_world_camera(stop, camera));
        check->least_floor_share = std::min(check->least_floor_share, share);
      }
    }
  }

  static double floor_share(const DepthPoints& points, const DepthNoise& noise, const Rigid3& T_world_camera) {
    std::size_t on_floor = 0;
    for (const Eigen::Vector3f& point : points.points) {
      const double height = (T_world_camera * point.cast<double>()).z();
      on_floor += std::abs(height) < kFloorM + 3.0 * noise.sigma_m(static_cast<double>(point.z()));
    }
    return static_cast<double>(on_floor) / static_cast<double>(std::max<std::size_t>(points.points.size(), 1));
  }

  void count_keypoints(SceneCheck* check) const {
    const cv::Ptr<cv::SIFT> sift = cv::SIFT::create();
    std::size_t keypoints = 0, images = 0;
    // One camera and every other stop: it is the place that matters.
    for (std::size_t stop = 0; stop < viewpoint_count(); stop += 2, ++images) {
      const fs::path file = recording_.folder / recording_.frames[0][stop].color_file;
      std::vector<cv::KeyPoint> found;
      sift->detect(cv::imread(file.string(), cv::IMREAD_GRAYSCALE), found);
      keypoints += found.size();
    }
    check->keypoints = static_cast<double>(keypoints) / static_cast<double>(std::max<std::size_t>(images, 1));
  }

  void take_pictures(SceneCheck* check) const {
    const std::size_t camera = recording_.frames.size() / 2;
    const std::vector<CameraFrame>& frames = recording_.frames[camera];
    check->towards_board = read_rgb(recording_.folder / frames.at(farthest_stop(camera)).color_file);
    if (recording_.segments.empty()) return;
    const std::vector<CameraFrame> straight = recording_.frames_of(recording_.segments.front(), camera);
    if (!straight.empty()) check->straight_ahead = read_rgb(recording_.folder / straight.front().color_file);
  }

  // The stop that shows most of the place.
  std::size_t farthest_stop(std::size_t camera) const {
    const auto distance = [&](std::size_t stop) {
      return (T_world_camera(stop, camera).translation - truth_.T_world_board.translation).norm();
    };
    std::size_t best = 0;
    for (std::size_t stop = 1; stop < viewpoint_count(); ++stop)
      if (distance(stop) > distance(best)) best = stop;
    return best;
  }

  Recording recording_;
  Truth truth_;
  Observations observations_;
};

}  // namespace

bool SceneCheck::ground_is_good() const {
  return 20 * grounds_found >= 19 * depth_images && worst_normal_deg <= kNormalLimitDeg &&
         worst_height_mm <= kHeightLimitMm + 1000.0 * kScaleSigma * kTypicalHeightM;
}

bool SceneCheck::board_is_good() const { return planned_board_everywhere && planned_whole_share >= kBoardWholeLimit; }

SceneCheck check_scene(const std::string& name_or_file, const SceneCheckOptions& options) {
  const SceneModel scene = load_scene_model(name_or_file);
  SceneCheck check;
  check.name = scene.name;
  check.description = scene.description;
  check.outdoor = scene.outdoor;
  plan_many(name_or_file, scene, options.planned_poses, &check);
  const ScratchFolder folder("scene");
  const RunFolder run{folder.path() / "run"};
  GenerateOptions generation;
  generation.output = run.root;
  generation.jobs = options.jobs;
  generation.device = options.device;
  generation.progress = options.progress;
  if (!generate(config_of(name_or_file, scene, options.poses), generation).complete)
    throw Error("interrupted", ExitCode::kTryAgain);
  Measurement(run, options.jobs).measure(&check);
  return check;
}

std::string format_checks(const std::vector<SceneCheck>& checks) {
  std::size_t width = 5;
  for (const SceneCheck& check : checks) width = std::max(width, check.name.size());
  std::string text =
      fmt::format("{:<{}}  board whole  found    ground   normal  height  floor from  keypoints\n", "scene", width);
  for (const SceneCheck& check : checks)
    text += fmt::format("{:<{}}  {:9.1f} %  {}/{}  {:4}/{}  {:4.2f} deg  {:3.1f} mm  {:8.0f} %  {:9.0f}  {}\n",
                        check.name, width, 100.0 * check.planned_whole_share, check.boards_found, check.boards_visible,
                        check.grounds_found, check.depth_images, check.worst_normal_deg, check.worst_height_mm,
                        100.0 * check.least_floor_share, check.keypoints,
                        check.ground_is_good() && check.board_is_good() ? "ok" : "FAIL");
  return text;
}

}  // namespace rigproof
