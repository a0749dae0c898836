#include "folder_import.h"

#include <algorithm>
#include <iterator>
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

// Ours, or one of the trajectories of others; reading it says what is wrong with it.
bool is_trajectory(const fs::path& file) {
  if (file.filename() == "odometry.csv") return true;
  if (file.extension() != ".txt" && file.extension() != ".csv" && file.extension() != ".tum") return false;
  if (file.filename() == "times.txt") return false;
  try {
    return looks_like_trajectory(file);
  } catch (const Error&) {
    return false;
  }
}

bool can_be_read(const fs::path& file) {
  try {
    return file.filename() == "odometry.csv" || !read_trajectory(file).empty();
  } catch (const Error&) {
    return false;
  }
}

// What columns mean that nobody names would be a guess: a fourth one may be a height, or degrees.
std::vector<OdometrySample> rows_of_odometry(const fs::path& file) {
  if (!has_odometry_header(file))
    throw Error(file.string() +
                ":1: what are its columns? Name them in a first line: stamp_s,x_m,y_m,yaw_rad, in seconds, metres and "
                "radians, whatever lies between them. Of TUM, EuRoC or KITTI give another name, poses.txt");
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

using ByCamera = std::map<std::string, std::string>;

// A camera of the recording and the images that are there of it.
struct FoundCamera {
  RigCamera rig;
  InitCamera report;
  std::vector<StampedFile> files;
};

fs::path info_file_of(const CameraFolder& from, const ByCamera& infos) {
  const auto info = infos.find(from.name);
  if (info != infos.end()) return info->second;
  const fs::path file = from.folder / "camera_info.yaml";
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored))
    throw Error("there are no intrinsics: " + file.string() +
                " is missing, as camera_calibration writes it; put it there or give --camera-info " + from.name +
                "=FILE");
  return file;
}

// Of images that are copied as they are.
Camera camera_of_copies(const std::string& name, const fs::path& info_file, std::vector<std::string>* notes) {
  const InfoReading reading = camera_of_file(info_file, name, "");
  if (!reading.to_undo.empty())
    throw Error(info_file.string() +
                ": no lens of ours comes near these coefficients, and images of a folder are copied as they are; give "
                "rectified images, and P as their camera_matrix");
  for (const std::string& text : reading.notes) notes->push_back(name + ": " + text);
  return reading.camera;
}

// What a sensor's depth is like, where the camera has any.
void take_depth(const CameraFolder& from, const ByCamera& sensors, FoundCamera* camera) {
  const bool any_depth = std::any_of(camera->files.begin(), camera->files.end(),
                                     [](const StampedFile& file) { return !file.depth.empty(); });
  if (const auto sensor = sensors.find(from.name); sensor != sensors.end()) {
    camera->rig.sensor = sensor->second;
    if (any_depth) camera->rig.depth = load_sensor_preset(sensor->second).depth;
  }
  if (!any_depth) return;
  if (!camera->rig.depth) camera->rig.depth = DepthStream();
  camera->report.depth = (from.folder / "depth").string();
}

FoundCamera describe_camera(const CameraFolder& from, const ByCamera& infos, const ByCamera& sensors,
                            std::vector<std::string>* notes, Problems* problems) {
  if (!is_frame_name(from.name))
    throw Error("a camera's name has letters, digits, \"_\", \"-\" and \".\"; rename the folder");
  FoundCamera camera;
  camera.report.name = camera.report.link = from.name;
  camera.rig.name = camera.rig.folder = camera.rig.link = from.name;
  const fs::path info_file = info_file_of(from, infos);
  camera.rig.camera = camera_of_copies(from.name, info_file, notes);
  camera.files = list_images(from.folder, problems);
  take_depth(from, sensors, &camera);
  camera.report.images = from.folder.string();
  camera.report.camera_info = info_file.string();
  camera.report.width_px = camera.rig.camera.width_px;
  camera.report.height_px = camera.rig.camera.height_px;
  camera.report.images_in_source = camera.files.size();
  return camera;
}

std::vector<FoundCamera> describe(const std::vector<CameraFolder>& folders, const InitOptions& options,
                                  std::vector<std::string>* notes) {
  std::vector<std::string> names;
  for (const CameraFolder& folder : folders) names.push_back(folder.name);
  const ByCamera infos = intrinsics_files(options.camera_infos, names);
  const ByCamera sensors = values_by_camera(options.sensors, "--sensor", names, true);
  std::vector<FoundCamera> cameras;
  Problems problems;
  for (const CameraFolder& folder : folders) {
    try {
      cameras.push_back(describe_camera(folder, infos, sensors, notes, &problems));
    } catch (const Error& error) {
      if (error.exit_code() == ExitCode::kTryAgain) throw;
      problems.add({"", 0, "camera " + folder.name, "", error.what()});
    }
  }
  problems.throw_if_any();
  return cameras;
}

// Of each camera.
std::vector<std::vector<double>> stamps_of(const std::vector<FoundCamera>& cameras) {
  std::vector<std::vector<double>> stamps_s;
  for (const FoundCamera& camera : cameras) {
    stamps_s.emplace_back();
    for (const StampedFile& file : camera.files) stamps_s.back().push_back(file.stamp_s);
  }
  return stamps_s;
}

std::string clock_text(const std::vector<double>& stamps_s, const std::vector<OdometrySample>& odometry) {
  if (stamps_s.empty()) return "";
  return ": images from " + fixed_text(stamps_s.front(), 3) + " to " + fixed_text(stamps_s.back(), 3) +
         " s, poses from " + fixed_text(odometry.front().stamp_s, 3) + " to " + fixed_text(odometry.back().stamp_s, 3) +
         " s; both need one clock";
}

// Throws Error with every camera of which none is kept.
void check_kept(const FrameChoice& kept, const std::vector<std::vector<double>>& stamps_s, const FolderPlan& plan) {
  Problems problems;
  for (std::size_t camera = 0; camera < stamps_s.size(); ++camera)
    if (kept.kept[camera].empty())
      problems.add({"", 0, "camera " + plan.report.cameras[camera].name, "",
                    "no image lies within the time of " + plan.report.odometry +
                        clock_text(stamps_s[camera], plan.recording.odometry)});
  problems.throw_if_any();
}

// The frames of one camera, and its files in the plan.
std::vector<CameraFrame> frames_of(const std::vector<StampedFile>& files, const std::vector<std::size_t>& kept,
                                   InitCamera* report, FolderPlan* plan) {
  std::vector<CameraFrame> frames;
  for (const std::size_t index : kept) {
    const StampedFile& file = files[index];
    CameraFrame frame;
    frame.stamp_s = file.stamp_s;
    const std::string number = file_number(frames.size());
    frame.color_file = report->name + "/color/" + number + file.color.extension().string();
    plan->copies.emplace_back(file.color, frame.color_file);
    ++report->images_kept;
    if (!file.depth.empty()) {
      frame.depth_file = report->name + "/depth/" + number + ".png";
      plan->copies.emplace_back(file.depth, frame.depth_file);
      ++report->depth_kept;
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

void keep_frames(const std::vector<FoundCamera>& cameras, const InitOptions& options, FolderPlan* plan) {
  InitReport& report = plan->report;
  const std::vector<std::vector<double>> stamps_s = stamps_of(cameras);
  const FrameChoice kept =
      choose_frames(stamps_s, plan->recording.odometry, {options.every_image, options.images_per_stop});
  check_kept(kept, stamps_s, *plan);
  report.stops = kept.stops;
  report.moving_images = kept.moving;
  for (const std::string& note : choice_notes(kept, options.images_per_stop)) report.notes.push_back(note);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    report.cameras[c].stops = kept.on_the_move ? kept.kept[c].size() : kept.stops_of_camera[c];
    plan->recording.frames.push_back(frames_of(cameras[c].files, kept.kept[c], &report.cameras[c], plan));
  }
}

}  // namespace

fs::path find_trajectory(const InitOptions& options) {
  if (!options.odometry.empty()) return options.odometry;
  std::vector<std::string> found, readable;
  std::error_code ignored;
  for (const fs::directory_entry& entry : folder_entries(options.source))
    if (entry.is_regular_file(ignored) && is_trajectory(entry.path())) found.push_back(entry.path().string());
  if (found.size() > 1) std::copy_if(found.begin(), found.end(), std::back_inserter(readable), can_be_read);
  if (!readable.empty()) found = readable;
  if (found.size() == 1) return found.front();
  throw Error(options.source.string() + ": " +
              (found.empty() ? std::string("holds no trajectory; give one with --odometry FILE: odometry.csv "
                                           "(stamp_s,x_m,y_m,yaw_rad), TUM, EuRoC or KITTI")
                             : "holds several trajectories, " + for_message(joined(found), 300) +
                                   "; say which: --odometry FILE"));
}

FolderPlan plan_folder_import(const InitOptions& options) {
  FolderPlan plan;
  Rig& rig = plan.recording.rig;
  rig.name = options.output.filename().string();
  rig.robot_frame = plan.report.robot_frame = options.robot_frame.empty() ? "base_footprint" : options.robot_frame;
  if (options.board) rig.board = *options.board;
  const std::vector<CameraFolder> folders = find_cameras(options.source);
  if (folders.empty())
    throw Error(options.source.string() + ": holds no bag, no images, and no folders with images (PNG or JPEG)");
  plan.recording.odometry = read_odometry(find_trajectory(options), &plan.report);
  const std::vector<FoundCamera> cameras = describe(folders, options, &plan.report.notes);
  for (const FoundCamera& camera : cameras) {
    rig.cameras.push_back(camera.rig);
    plan.report.cameras.push_back(camera.report);
  }
  keep_frames(cameras, options, &plan);
  return plan;
}

}  // namespace rigproof
