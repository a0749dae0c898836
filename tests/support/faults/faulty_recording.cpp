#include "faulty_recording.h"

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/odometry_csv.h"
#include "rigproof/core/text.h"

namespace rigproof::faults {
namespace {

namespace fs = std::filesystem;

void link_all(const fs::path& from, const fs::path& to) {
  fs::create_directories(to);
  for (const auto& entry : fs::recursive_directory_iterator(from)) {
    const fs::path target = to / fs::relative(entry.path(), from);
    if (entry.is_directory())
      fs::create_directories(target);
    else
      fs::create_hard_link(entry.path(), target);
  }
}

// By a new name: what shares the old content keeps it.
void write_png(const fs::path& file, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  write_file_atomically_unsynced(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void link_anew(const fs::path& from, const fs::path& to) {
  fs::remove(to);
  fs::create_hard_link(from, to);
}

void edit_images(const fs::path& folder, const std::vector<CameraFrame>& frames, std::string CameraFrame::*which,
                 const FaultyRecording::EditImage& edit) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const fs::path file = folder / (frames[i].*which);
    cv::Mat image = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
    if (image.empty()) throw Error(file.string() + ": is no image");
    edit(i, &image);
    write_png(file, image);
  }
}

std::string frames_csv_of(const std::vector<CameraFrame>& frames, const std::string& folder) {
  std::string text = "file,stamp_s,exposure_s\n";
  for (const CameraFrame& frame : frames)
    text += frame.color_file.substr(folder.size() + 1) + "," + number_text(frame.stamp_s) + "," +
            number_text(frame.exposure_s) + "\n";
  return text;
}

std::vector<Eigen::Vector3f> points_of(const cv::Mat& depth, const RigCamera& camera) {
  constexpr int kStride = 2;
  std::vector<Eigen::Vector3f> points;
  Eigen::Vector3d ray;
  for (int v = 0; v < depth.rows; v += kStride)
    for (int u = 0; u < depth.cols; u += kStride)
      if (const double z = camera.depth->unit_m * depth.at<std::uint16_t>(v, u);
          z > 0.0 && camera.camera.unproject({u, v}, &ray))
        points.push_back((z * ray).cast<float>());
  return points;
}

std::string pcd_of(const std::vector<Eigen::Vector3f>& points) {
  const std::string count = std::to_string(points.size());
  std::string text = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count +
                     "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
  for (const Eigen::Vector3f& point : points) text.append(reinterpret_cast<const char*>(point.data()), 12);
  return text;
}

}  // namespace

FaultyRecording::FaultyRecording(fs::path run, const fs::path& folder, std::uint64_t seed)
    : run_(std::move(run)), seed_(seed) {
  link_all(run_ / "recording", folder);
  recording_ = load_recording(folder);
}

std::size_t FaultyRecording::camera_with(const std::function<bool(const RigCamera&)>& holds) {
  std::vector<std::size_t> those;
  for (std::size_t k = 0; k < cameras(); ++k)
    if (holds(recording_.rig.cameras[k])) those.push_back(k);
  if (those.empty()) throw std::logic_error("a fault does not fit the rig " + recording_.rig.name);
  const std::size_t chosen = those[seed_ % those.size()];
  broken_.insert(recording_.rig.cameras[chosen].name);
  return chosen;
}

std::size_t FaultyRecording::any_camera() {
  return camera_with([](const RigCamera&) { return true; });
}

std::size_t FaultyRecording::depth_camera() {
  return camera_with([](const RigCamera& camera) { return camera.depth.has_value(); });
}

void FaultyRecording::edit_rig(const std::function<void(Rig*)>& edit) {
  edit(&recording_.rig);
  save_rig(recording_.rig, folder() / "rig.yaml");
}

void FaultyRecording::edit_odometry(const std::function<void(std::vector<OdometrySample>*)>& edit) {
  edit(&recording_.odometry);
  write_file_atomically_unsynced(folder() / "odometry.csv", odometry_csv(recording_.odometry));
}

void FaultyRecording::edit_odometry_text(const std::function<std::string(const std::string&)>& edit) {
  const fs::path file = folder() / "odometry.csv";
  write_file_atomically_unsynced(file, edit(read_text_file(file)));
}

void FaultyRecording::edit_frames(std::size_t camera, const std::function<void(std::vector<CameraFrame>*)>& edit) {
  std::vector<CameraFrame>& frames = recording_.frames[camera];
  const std::string& name = recording_.rig.cameras[camera].folder;
  edit(&frames);
  write_file_atomically_unsynced(folder() / name / "frames.csv", frames_csv_of(frames, name));
}

void FaultyRecording::edit_color(std::size_t camera, const EditImage& edit) {
  edit_images(folder(), recording_.frames[camera], &CameraFrame::color_file, edit);
}

void FaultyRecording::edit_depth(std::size_t camera, const EditImage& edit) {
  edit_images(folder(), recording_.frames[camera], &CameraFrame::depth_file, edit);
}

void FaultyRecording::depth_to_clouds(std::size_t camera,
                                      const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& move) {
  const RigCamera& seen = recording_.rig.cameras[camera];
  for (CameraFrame& frame : recording_.frames[camera]) {
    const fs::path depth = folder() / frame.depth_file;
    std::vector<Eigen::Vector3f> points = points_of(cv::imread(depth.string(), cv::IMREAD_UNCHANGED), seen);
    for (Eigen::Vector3f& point : points) point = move(point);
    frame.cloud_file = (fs::path(seen.folder) / "cloud" / depth.stem()).string() + ".pcd";
    frame.depth_file.clear();
    write_file_atomically_unsynced(folder() / frame.cloud_file, pcd_of(points));
    fs::remove(depth);
  }
}

void FaultyRecording::replace(const std::string& file, const std::string& by) {
  link_anew(folder() / by, folder() / file);
}

void FaultyRecording::replace_by_variant(const std::string& file, const std::string& variant) {
  const fs::path other = run_.string() + "-" + variant;
  link_anew(other / "recording" / file, folder() / file);
}

void FaultyRecording::rearrange(std::size_t camera, std::string CameraFrame::*which,
                                const std::function<std::size_t(std::size_t)>& source) {
  const std::vector<CameraFrame>& frames = recording_.frames[camera];
  std::vector<std::string> before;
  for (const CameraFrame& frame : frames) before.push_back(read_text_file(folder() / (frame.*which)));
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (source(i) != i) write_file_atomically_unsynced(folder() / (frames[i].*which), before.at(source(i)));
}

}  // namespace rigproof::faults
