#include "rigproof/study/convert.h"

#include <algorithm>
#include <system_error>

#include "rigproof/calib/ground_plane.h"
#include "rigproof/calib/image_io.h"
#include "rigproof/calib/stops.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/formats/memroc_writer.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

/// A folder that gets its name when it is whole, and is gone again if that never happens.
class FolderInMaking {
 public:
  explicit FolderInMaking(fs::path folder) : folder_(std::move(folder)), making_(folder_.string() + ".partial") {
    std::error_code error;
    if (fs::exists(folder_, error) && !(fs::is_directory(folder_, error) && fs::is_empty(folder_, error)))
      throw Error(folder_.string() + ": there is something already; name a new folder");
    fs::remove_all(making_, error);
    fs::create_directories(making_, error);
    if (error) throw Error(making_.string() + ": " + error.message());
  }
  ~FolderInMaking() {
    std::error_code ignored;
    if (!done_) fs::remove_all(making_, ignored);
  }
  FolderInMaking(const FolderInMaking&) = delete;
  FolderInMaking& operator=(const FolderInMaking&) = delete;

  const fs::path& path() const { return making_; }
  void finish() {
    std::error_code error;
    fs::remove(folder_, error);
    fs::rename(making_, folder_, error);
    if (error) throw Error(folder_.string() + ": " + error.message());
    done_ = true;
  }

 private:
  fs::path folder_, making_;
  bool done_ = false;
};

void copy_file_into(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (!error) fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) throw Error(from.string() + ": cannot be copied to " + to.string() + ": " + error.message());
}

void step(const ConvertOptions& options, std::size_t done, std::size_t total) {
  if (options.progress && !options.progress(done, total)) throw Error("interrupted", ExitCode::kTryAgain);
}

std::size_t image_count(const Recording& recording) {
  std::size_t count = 0;
  for (const auto& frames : recording.frames) count += frames.size();
  return count;
}

/// Writes cameraN/ by cameraN/; everything of a stop has the stop's number.
class MemrocWriter {
 public:
  MemrocWriter(const Recording& recording, const fs::path& folder, const ConvertOptions& options)
      : recording_(recording),
        folder_(folder),
        options_(options),
        plan_(detection::plan_stops(recording, ObserveOptions())) {}

  ConvertReport write() {
    write_file_atomically_unsynced(folder_ / "CalibrationInfo.yaml", memroc_calibration_info(recording_.rig));
    for (std::size_t k = 0; k < recording_.rig.cameras.size(); ++k) write_camera(k);
    add_notes();
    return report_;
  }

 private:
  void write_camera(std::size_t k) {
    const RigCamera& camera = recording_.rig.cameras[k];
    const fs::path folder = folder_ / memroc_camera_folder(k);
    fs::create_directories(folder / "image");
    fs::create_directories(folder / "pose");
    if (camera.depth) fs::create_directories(folder / "clouds");
    write_file_atomically_unsynced(folder / "intrinsic_pars_file.yaml", memroc_intrinsics(camera.camera));
    for (std::size_t i = 0; i < plan_.stops.size(); ++i) {
      const std::vector<int>& frames = plan_.stops[i].frames[k];
      if (frames.empty()) continue;
      const int middle = frames[frames.size() / 2];
      write_frame(camera, recording_.frames[k][static_cast<std::size_t>(middle)], i, folder);
      step(options_, ++report_.images, image_total());
    }
  }

  std::size_t image_total() const {
    std::size_t count = 0;
    for (const detection::PlannedStop& stop : plan_.stops)
      for (const std::vector<int>& frames : stop.frames) count += !frames.empty();
    return count;
  }

  void write_frame(const RigCamera& camera, const CameraFrame& frame, std::size_t number, const fs::path& folder) {
    const std::string name = memroc_frame_name(number);
    const fs::path image = path_inside(recording_.folder, frame.color_file);
    copy_file_into(image, folder / "image" / (name + image.extension().string()));
    const Stop& stop = plan_.stops[number].stop;
    write_file_atomically_unsynced(folder / "pose" / (name + ".csv"),
                                   memroc_pose(planar_pose(stop.x_m, stop.y_m, stop.yaw_rad)));
    write_cloud(camera, frame, folder / "clouds" / name);
  }

  // A cloud that is text already stays as it is.
  void write_cloud(const RigCamera& camera, const CameraFrame& frame, const fs::path& file) {
    const fs::path text_file = file.string() + ".txt";
    const std::string& cloud_file = frame.cloud_file;
    if (!cloud_file.empty() && fs::path(cloud_file).extension() != ".pcd") {
      copy_file_into(path_inside(recording_.folder, cloud_file), text_file);
    } else if (!cloud_file.empty()) {
      write_points(read_cloud(cloud_file), text_file);
    } else if (!frame.depth_file.empty() && camera.depth) {
      write_points(read_depth(camera, frame.depth_file), text_file);
    } else {
      return;
    }
    ++report_.clouds;
  }

  void write_points(const std::vector<Eigen::Vector3f>& points, const fs::path& file) const {
    write_file_atomically_unsynced(file, memroc_cloud(points));
  }

  std::vector<Eigen::Vector3f> read_cloud(const std::string& name) const {
    auto cloud = read_point_cloud(path_inside(recording_.folder, name));
    if (const auto* failure = std::get_if<Unreadable>(&cloud)) throw Error(name + ": " + failure->reason);
    const auto& all = std::get<std::vector<Eigen::Vector3f>>(cloud);
    const std::size_t stride = all.size() / static_cast<std::size_t>(options_.max_cloud_points) + 1;
    std::vector<Eigen::Vector3f> points;
    for (std::size_t i = 0; i < all.size(); i += stride) points.push_back(all[i]);
    return points;
  }

  std::vector<Eigen::Vector3f> read_depth(const RigCamera& camera, const std::string& name) const {
    const auto depth = read_depth_image(path_inside(recording_.folder, name));
    if (const auto* failure = std::get_if<Unreadable>(&depth)) throw Error(name + ": " + failure->reason);
    const Image16& image = std::get<Image16>(depth);
    int stride = 1;
    while ((image.width / stride) * (image.height / stride) > options_.max_cloud_points) ++stride;
    return points_from_depth(image, camera, stride).points;
  }

  void add_notes() {
    for (std::size_t k = 0; k < recording_.rig.cameras.size(); ++k) {
      const std::string name = memroc_camera_folder(k);
      if (recording_.rig.cameras[k].name != name)
        report_.notes.push_back(recording_.rig.cameras[k].name + " is " + name + " there.");
    }
    if (!plan_.exclusions.empty())
      report_.notes.push_back(std::to_string(plan_.exclusions.size()) +
                              " images are left out: without odometry, or of a standstill that has others.");
    report_.notes.emplace_back("Stamps, depth noise and names have no place in that layout.");
  }

  const Recording& recording_;
  const fs::path folder_;
  const ConvertOptions& options_;
  const detection::StopPlan plan_;
  ConvertReport report_;
};

void refuse_what_memroc_cannot_say(const Recording& recording) {
  Problems problems;
  const std::string file = (recording.folder / "rig.yaml").string();
  for (const RigCamera& camera : recording.rig.cameras)
    if (camera.camera.lens == Lens::kKannalaBrandt)
      problems.add({file, 0, "cameras." + camera.name + ".lens", lens_name(camera.camera.lens),
                    "the MEMROC layout only has pinhole and brown_conrady"});
  if (recording.rig.board.ambiguous_under_half_turn())
    problems.add({file, 0, "board", "",
                  "the board looks the same when turned by 180 degrees, so its first corner cannot be told"});
  problems.throw_if_any();
}

}  // namespace

ConvertReport copy_recording(const Recording& recording, const fs::path& folder, const ConvertOptions& options) {
  FolderInMaking making(folder);
  Recording copy = recording;
  copy.folder = making.path();
  ConvertReport report;
  const std::size_t total = image_count(recording);
  for (const std::vector<CameraFrame>& frames : recording.frames) {
    for (const CameraFrame& frame : frames) {
      for (const std::string* file : {&frame.color_file, &frame.depth_file, &frame.cloud_file})
        if (!file->empty()) copy_file_into(path_inside(recording.folder, *file), making.path() / *file);
      report.clouds += !frame.cloud_file.empty();
      step(options, ++report.images, total);
    }
  }
  for (const RigCamera& camera : recording.rig.cameras) fs::create_directories(making.path() / camera.folder);
  save_recording(copy);
  making.finish();
  return report;
}

ConvertReport write_memroc_layout(const Recording& recording, const fs::path& folder, const ConvertOptions& options) {
  refuse_what_memroc_cannot_say(recording);
  FolderInMaking making(folder);
  ConvertReport report = MemrocWriter(recording, making.path(), options).write();
  making.finish();
  return report;
}

}  // namespace rigproof
