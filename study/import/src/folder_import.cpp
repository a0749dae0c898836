#include "folder_import.h"

#include <algorithm>
#include <map>

#include "frame_choice.h"
#include "ground_track.h"
#include "image_list.h"
#include "import_words.h"
#include "rig_files.h"
#include "rigproof/core/error.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/odometry_csv.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/trajectory.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

struct CameraFolder {
  std::string name;
  fs::path folder;
};

std::vector<CameraFolder> find_cameras(const fs::path& source) {
  std::vector<CameraFolder> cameras;
  std::error_code ignored;
  for (const fs::directory_entry& entry : folder_entries(source))
    if (entry.is_directory(ignored) && entry.path().filename() != "depth" && has_images(entry.path()))
      cameras.push_back({entry.path().filename().string(), entry.path()});
  std::sort(cameras.begin(), cameras.end(),
            [](const CameraFolder& a, const CameraFolder& b) { return a.name < b.name; });
  // The usual folders below one camera are not cameras.
  const bool one = has_images(source) &&
                   (cameras.empty() || std::all_of(cameras.begin(), cameras.end(), [](const CameraFolder& camera) {
                      return camera.name == "color" || camera.name == "image" || camera.name == "images" ||
                             camera.name == "data" || camera.name == "rgb";
                    }));
  if (one) return {{"camera", source}};
  return cameras;
}

// Ours, or one of the trajectories of others.
bool is_trajectory(const fs::path& file) {
  if (file.filename() == "odometry.csv") return true;
  if (file.extension() != ".txt" && file.extension() != ".csv" && file.extension() != ".tum") return false;
  if (file.filename() == "times.txt") return false;
  try {
    return !read_trajectory(file).empty();
  } catch (const Error&) {
    return false;
  }
}

std::vector<OdometrySample> rows_of_odometry(const fs::path& file) {
  Problems problems;
  std::vector<OdometrySample> odometry = read_odometry_csv(file, &problems);
  problems.throw_if_any();
  return odometry;
}

GroundTrack track_of_trajectory(const fs::path& file) {
  constexpr double kUpright_deg = 30.0;
  std::vector<TimedPose> poses;
  for (const TrajectoryPose& pose : read_trajectory(file)) poses.push_back({pose.stamp_s, pose.T_world_body});
  GroundTrack track = ground_track(poses);
  if (track.tilt_deg > kUpright_deg)
    throw Error(file.string() + ": its poses tilt by up to " + fixed_text(track.tilt_deg, 0) +
                " deg: z does not point up, in the world or in what moves; write poses of the robot with x forward "
                "and z up");
  return track;
}

// Says in the report what was read.
std::vector<OdometrySample> read_odometry(const fs::path& file, InitReport* report) {
  report->odometry = file.filename().string();
  GroundTrack track;
  if (report->odometry == "odometry.csv") {
    track.odometry = rows_of_odometry(file);
  } else {
    track = track_of_trajectory(file);
    report->tilt_deg = track.tilt_deg;
    report->rise_m = track.rise_m;
    if (const std::string note = level_note(report->odometry, track); !note.empty()) report->notes.push_back(note);
  }
  if (track.odometry.size() < 2) throw Error(file.string() + ": has fewer than two poses");
  report->odometry_rows = track.odometry.size();
  report->duration_s = track.odometry.back().stamp_s - track.odometry.front().stamp_s;
  return track.odometry;
}

// Of each camera.
std::vector<std::vector<double>> stamps_of(const std::vector<std::vector<StampedFile>>& files) {
  std::vector<std::vector<double>> stamps_s;
  for (const std::vector<StampedFile>& of_camera : files) {
    stamps_s.emplace_back();
    for (const StampedFile& file : of_camera) stamps_s.back().push_back(file.stamp_s);
  }
  return stamps_s;
}

class FolderPlanner {
 public:
  explicit FolderPlanner(const InitOptions& options) : options_(options) {}

  FolderPlan run() {
    plan_.recording.rig.name = options_.output.filename().string();
    plan_.recording.rig.robot_frame = options_.robot_frame.empty() ? "base_footprint" : options_.robot_frame;
    plan_.report.robot_frame = plan_.recording.rig.robot_frame;
    if (options_.board) plan_.recording.rig.board = *options_.board;
    const std::vector<CameraFolder> cameras = find_cameras(options_.source);
    if (cameras.empty())
      throw Error(options_.source.string() + ": holds no bag, no images, and no folders with images (PNG or JPEG)");
    plan_.recording.odometry = read_odometry(find_trajectory(options_), &plan_.report);
    describe(cameras);
    keep_frames(stamps_of(files_));
    return std::move(plan_);
  }

 private:
  void describe(const std::vector<CameraFolder>& cameras) {
    std::vector<std::string> names;
    for (const CameraFolder& camera : cameras) names.push_back(camera.name);
    const auto infos = intrinsics_files(options_.camera_infos, names);
    const auto sensors = values_by_camera(options_.sensors, "--sensor", names, true);
    Problems problems;
    for (const CameraFolder& camera : cameras) {
      try {
        describe_camera(camera, infos, sensors, &problems);
      } catch (const Error& error) {
        if (error.exit_code() == ExitCode::kTryAgain) throw;
        problems.add({"", 0, "camera " + camera.name, "", error.what()});
      }
    }
    problems.throw_if_any();
  }

  void describe_camera(const CameraFolder& from, const std::map<std::string, std::string>& infos,
                       const std::map<std::string, std::string>& sensors, Problems* problems) {
    if (!is_frame_name(from.name))
      throw Error("a camera's name has letters, digits, \"_\", \"-\" and \".\"; rename the folder");
    InitCamera report;
    report.name = from.name;
    report.images = from.folder.string();
    const auto info = infos.find(from.name);
    const fs::path info_file = info == infos.end() ? from.folder / "camera_info.yaml" : fs::path(info->second);
    std::error_code ignored;
    if (!fs::is_regular_file(info_file, ignored))
      throw Error("there are no intrinsics: " + info_file.string() +
                  " is missing, as camera_calibration writes it; put it there or give --camera-info " + from.name +
                  "=FILE");
    RigCamera camera;
    camera.name = camera.folder = camera.link = report.link = from.name;
    camera.camera = camera_of_copies(from.name, info_file);
    report.camera_info = info_file.string();
    report.width_px = camera.camera.width_px;
    report.height_px = camera.camera.height_px;
    files_.push_back(list_images(from.folder, problems));
    const bool any_depth = std::any_of(files_.back().begin(), files_.back().end(),
                                       [](const StampedFile& file) { return !file.depth.empty(); });
    if (const auto sensor = sensors.find(from.name); sensor != sensors.end()) {
      camera.sensor = sensor->second;
      if (any_depth) camera.depth = load_sensor_preset(sensor->second).depth;
    }
    if (any_depth && !camera.depth) camera.depth = DepthStream();
    if (any_depth) report.depth = (from.folder / "depth").string();
    report.images_in_source = files_.back().size();
    plan_.recording.rig.cameras.push_back(camera);
    plan_.report.cameras.push_back(report);
  }

  // Of images that are copied as they are.
  Camera camera_of_copies(const std::string& name, const fs::path& info_file) {
    const InfoReading reading = camera_of_file(info_file, name, "");
    if (!reading.to_undo.empty())
      throw Error(info_file.string() + ": " + reading.notes.front() +
                  "; of a folder they are copied: give rectified ones, and P as their camera_matrix");
    for (const std::string& text : reading.notes) plan_.report.notes.push_back(name + ": " + text);
    return reading.camera;
  }

  void keep_frames(const std::vector<std::vector<double>>& stamps_s) {
    const FrameChoice kept =
        choose_frames(stamps_s, plan_.recording.odometry, {options_.every_image, options_.images_per_stop});
    plan_.report.stops = kept.stops;
    plan_.report.moving_images = kept.moving;
    for (const std::string& note : choice_notes(kept, options_.images_per_stop)) plan_.report.notes.push_back(note);
    Problems problems;
    for (std::size_t camera = 0; camera < files_.size(); ++camera) {
      if (kept.kept[camera].empty())
        problems.add({"", 0, "camera " + plan_.report.cameras[camera].name, "",
                      "no image lies within the time of " + plan_.report.odometry + clock_text(stamps_s[camera])});
      keep_frames_of(camera, kept);
    }
    problems.throw_if_any();
  }

  std::string clock_text(const std::vector<double>& stamps_s) const {
    if (stamps_s.empty()) return "";
    const auto& odometry = plan_.recording.odometry;
    return ": images from " + fixed_text(stamps_s.front(), 3) + " to " + fixed_text(stamps_s.back(), 3) +
           " s, poses from " + fixed_text(odometry.front().stamp_s, 3) + " to " +
           fixed_text(odometry.back().stamp_s, 3) + " s; both need one clock";
  }

  void keep_frames_of(std::size_t camera, const FrameChoice& kept) {
    InitCamera& report = plan_.report.cameras[camera];
    report.stops = kept.on_the_move ? kept.kept[camera].size() : kept.stops_of_camera[camera];
    std::vector<CameraFrame> frames;
    for (const std::size_t index : kept.kept[camera]) {
      const StampedFile& file = files_[camera][index];
      CameraFrame frame;
      frame.stamp_s = file.stamp_s;
      const std::string number = file_number(frames.size());
      frame.color_file = report.name + "/color/" + number + file.color.extension().string();
      plan_.copies.emplace_back(file.color, frame.color_file);
      ++report.images_kept;
      if (!file.depth.empty()) {
        frame.depth_file = report.name + "/depth/" + number + ".png";
        plan_.copies.emplace_back(file.depth, frame.depth_file);
        ++report.depth_kept;
      }
      frames.push_back(std::move(frame));
    }
    plan_.recording.frames.push_back(std::move(frames));
  }

  const InitOptions& options_;
  FolderPlan plan_;
  std::vector<std::vector<StampedFile>> files_;  // [camera]
};

}  // namespace

fs::path find_trajectory(const InitOptions& options) {
  if (!options.odometry.empty()) return options.odometry;
  std::vector<std::string> found;
  std::error_code ignored;
  for (const fs::directory_entry& entry : folder_entries(options.source))
    if (entry.is_regular_file(ignored) && is_trajectory(entry.path())) found.push_back(entry.path().string());
  if (found.size() == 1) return found.front();
  throw Error(options.source.string() + ": " +
              (found.empty() ? std::string("holds no trajectory; give one with --odometry FILE: odometry.csv "
                                           "(stamp_s,x_m,y_m,yaw_rad), TUM, EuRoC or KITTI")
                             : "holds several trajectories, " + for_message(joined(found), 300) +
                                   "; say which: --odometry FILE"));
}

FolderPlan plan_folder_import(const InitOptions& options) { return FolderPlanner(options).run(); }

}  // namespace rigproof
