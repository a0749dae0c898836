#include "rigproof/study/record/bag_of_recording.h"

#include <algorithm>
#include <cmath>

#include "bag_frames.h"
#include "bag_pictures.h"
#include "rigproof/bags/bag_writer.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOdometryFrame = "odom";

BagPacking packing_of(const std::string& name) {
  const std::vector<std::string> names = bag_packings();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw Error("packing " + for_message(name) + ": " + suggestion(name, names));
  return std::vector{BagPacking::kZstd, BagPacking::kLz4,
                     BagPacking::kNone}[static_cast<std::size_t>(found - names.begin())];
}

// Whole seconds apart: a product would lose the last digits of seconds since 1970.
std::int64_t nanoseconds(double stamp_s) {
  const double whole = std::floor(stamp_s);
  return static_cast<std::int64_t>(whole) * 1000000000 + std::llround((stamp_s - whole) * 1e9);
}

/// What comes next in the bag: a row of the odometry, or an image of a camera.
struct Event {
  double stamp_s = 0.0;
  std::size_t source = 0;  ///< camera, or how many there are for the odometry
  std::size_t index = 0;
};

std::vector<Event> events_of(const Recording& recording) {
  std::vector<Event> events;
  for (std::size_t i = 0; i < recording.odometry.size(); ++i)
    events.push_back({recording.odometry[i].stamp_s, recording.frames.size(), i});
  for (std::size_t camera = 0; camera < recording.frames.size(); ++camera)
    for (std::size_t i = 0; i < recording.frames[camera].size(); ++i)
      events.push_back({recording.frames[camera][i].stamp_s, camera, i});
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.stamp_s < b.stamp_s; });
  return events;
}

std::size_t pictures_of(const Recording& recording) {
  std::size_t count = 0;
  for (const auto& frames : recording.frames)
    for (const CameraFrame& frame : frames) count += 1 + (frame.depth_file.empty() ? 0 : 1);
  return count;
}

void take_velocity(const OdometrySample& before, const OdometrySample& row, RosOdometry* odometry) {
  const double dt = row.stamp_s - before.stamp_s;
  const Eigen::Vector3d step(row.x_m - before.x_m, row.y_m - before.y_m, 0.0);
  odometry->velocity = odometry->T_odom_child.rotation.conjugate() * step / dt;
  odometry->angular_velocity.z() = wrap_angle(row.yaw_rad - before.yaw_rad) / dt;
}

RosOdometry odometry_message(const Recording& recording, std::size_t index) {
  const OdometrySample& row = recording.odometry[index];
  RosOdometry odometry;
  odometry.header = {nanoseconds(row.stamp_s), kOdometryFrame};
  odometry.child_frame_id = recording.rig.robot_frame;
  odometry.T_odom_child = planar_pose(row.x_m, row.y_m, row.yaw_rad);
  if (index > 0) take_velocity(recording.odometry[index - 1], row, &odometry);
  return odometry;
}

std::vector<RosTransform> transforms_of(const FrameTree& tree, std::int64_t stamp_ns) {
  std::vector<RosTransform> transforms;
  for (const auto& [child, edge] : tree.edges())
    transforms.push_back({{stamp_ns, edge.parent}, child, edge.T_parent_child, ""});
  return transforms;
}

std::vector<std::string> notes_of(const Recording& recording, const FrameTree& tree) {
  std::vector<std::string> unmounted, notes;
  for (const RigCamera& camera : recording.rig.cameras)
    if (!tree.between(recording.rig.robot_frame, optical_frame_in_bag(camera))) unmounted.push_back(camera.name);
  if (!unmounted.empty())
    notes.push_back("/tf_static does not say where " + joined(unmounted) + (unmounted.size() > 1 ? " are" : " is") +
                    " mounted: that is sought");
  if (const Eigen::Vector2d& centre_m = recording.rig.odometry_noise.rotation_centre_m; !centre_m.isZero(0.0))
    notes.push_back("the odometry is of the point about which the robot turns, [" + fixed_text(1e3 * centre_m.x(), 0) +
                    ", " + fixed_text(1e3 * centre_m.y(), 0) + "] mm in its frame: a bag has no place for that");
  if (!recording.segments.empty()) notes.emplace_back("segments.csv is left out: a bag has no place for it");
  return notes;
}

// Writes messages and counts them.
class Writer {
 public:
  Writer(const Recording& recording, const fs::path& file, const BagOptions& options)
      : recording_(recording),
        options_(options),
        bag_(file, packing_of(options.packing)),
        total_(pictures_of(recording)) {}

  BagReport run() {
    const std::vector<Event> events = events_of(recording_);
    const FrameTree tree = frames_of_bag(recording_);
    const std::int64_t first_ns = events.empty() ? 0 : nanoseconds(events.front().stamp_s);
    put("/tf_static", kTfType, first_ns, message_bytes(transforms_of(tree, first_ns)));
    for (const Event& event : events)
      if (event.source == recording_.frames.size())
        write_odometry(event.index);
      else
        write_frame(recording_.rig.cameras[event.source], recording_.frames[event.source][event.index]);
    bag_.finish();
    report_.notes = notes_of(recording_, tree);
    return std::move(report_);
  }

 private:
  void put(const std::string& topic, const char* type, std::int64_t stamp_ns, std::string_view bytes) {
    bag_.write(topic, type, stamp_ns, bytes);
    if (std::find(report_.topics.begin(), report_.topics.end(), topic) == report_.topics.end())
      report_.topics.push_back(topic);
  }

  void write_odometry(std::size_t index) {
    const RosOdometry odometry = odometry_message(recording_, index);
    put("/odom", kOdometryType, odometry.header.stamp_ns, message_bytes(odometry));
    ++report_.odometry;
  }

  void write_frame(const RigCamera& camera, const CameraFrame& frame) {
    const std::string name = "/" + camera.name;
    const RosHeader header{nanoseconds(frame.stamp_s), optical_frame_in_bag(camera)};
    const fs::path color = path_inside(recording_.folder, frame.color_file);
    write_picture(name, camera.camera, header, color_message_of(color, header, options_.compressed_images));
    ++report_.images;
    tell_progress();
    if (!frame.cloud_file.empty()) write_cloud(name, frame, header);
    if (frame.depth_file.empty() || !camera.depth) return;
    const RosHeader deep{header.stamp_ns, depth_frame_in_bag(camera)};
    const Camera& lens = camera.depth->own_camera ? camera.depth->own_camera->camera : camera.camera;
    write_picture(name + "/depth", lens, deep,
                  depth_message_of(path_inside(recording_.folder, frame.depth_file), deep, camera.depth->unit_m,
                                   options_.compressed_images));
    ++report_.depth_images;
    tell_progress();
  }

  // Points are in the frame of the pictures.
  void write_cloud(const std::string& name, const CameraFrame& frame, const RosHeader& header) {
    const PictureMessage cloud = cloud_message_of(path_inside(recording_.folder, frame.cloud_file), header);
    put(name + "/points", cloud.type.c_str(), header.stamp_ns, cloud.bytes);
    ++report_.clouds;
  }

  void write_picture(const std::string& name, const Camera& lens, const RosHeader& header,
                     const PictureMessage& picture) {
    put(name + "/camera_info", kCameraInfoType, header.stamp_ns, message_bytes(camera_info_of(lens, header)));
    put(name + "/image_raw" + picture.transport, picture.type.c_str(), header.stamp_ns, picture.bytes);
  }

  void tell_progress() const {
    if (options_.progress && !options_.progress(report_.images + report_.depth_images, total_))
      throw Error("interrupted", ExitCode::kTryAgain);
  }

  const Recording& recording_;
  const BagOptions& options_;
  BagWriter bag_;
  BagReport report_;
  std::size_t total_;
};

}  // namespace

std::vector<std::string> bag_packings() { return {"zstd", "lz4", "none"}; }

BagReport write_bag(const Recording& recording, const fs::path& file, const BagOptions& options) {
  return Writer(recording, file, options).run();
}

}  // namespace rigproof
