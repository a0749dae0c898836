#include "bag_import.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "depth_of_bag.h"
#include "ground_track.h"
#include "import_words.h"
#include "rig_files.h"
#include "rigproof/core/error.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"
#include "topic_names.h"

namespace rigproof {
namespace {

constexpr const char* kGroundFrame = "base_footprint";

// Whole seconds apart: nanoseconds since 1970 are more digits than a double has.
double seconds(std::int64_t ns) {
  constexpr std::int64_t kNsPerS = 1000000000;
  return static_cast<double>(ns / kNsPerS) + 1e-9 * static_cast<double>(ns % kNsPerS);
}

class Planner {
 public:
  Planner(const BagSurvey& survey, const InitOptions& options) : survey_(survey), options_(options) {}

  ImportPlan run() {
    choice_ = choose_topics(survey_, topic_rules(options_.topics));
    plan_.recording.rig.name = options_.output.filename().string();
    if (options_.board) plan_.recording.rig.board = *options_.board;
    add_notes(choice_.notes);
    for (const std::string& text : survey_.tf_static.left_out()) note("/tf_static: left out is " + text);
    describe(choice_.cameras);
    take_odometry(*choice_.odometry);
    add_notes(notes_of_clocks());
    keep_frames(stamps_of(plan_.images));
    return std::move(plan_);
  }

 private:
  void note(const std::string& text) { plan_.report.notes.push_back(text); }
  void add_notes(const std::vector<std::string>& texts) {
    plan_.report.notes.insert(plan_.report.notes.end(), texts.begin(), texts.end());
  }

  // ------------------------------------------------------------------------------------------------------ cameras

  void describe(const std::vector<CameraTopics>& cameras) {
    std::vector<std::string> names;
    for (const CameraTopics& camera : cameras) names.push_back(camera.name);
    const auto infos = intrinsics_files(options_.camera_infos, names);
    const auto sensors = values_by_camera(options_.sensors, "--sensor", names, true);
    Problems problems;
    for (const CameraTopics& topics : cameras) {
      try {
        describe_camera(topics, infos, sensors);
      } catch (const Error& error) {
        if (error.exit_code() == ExitCode::kTryAgain) throw;
        problems.add({"", 0, "camera " + topics.name, "", error.what()});
      }
    }
    problems.throw_if_any();
    if (!without_sensor_.empty())
      note("depth of " + joined(without_sensor_) +
           " is taken for that of a common stereo camera; say what it is: --sensor d455, or `sensor: d455` "
           "below each in rig.yaml (`rigproof sensors` lists them)");
  }

  void describe_camera(const CameraTopics& topics, const std::map<std::string, std::string>& infos,
                       const std::map<std::string, std::string>& sensors) {
    const ImageTopic& images = *survey_.find_image(topics.images);
    if (images.frame_ids.size() > 1)
      throw Error(images.name + " carries images of several frames, " +
                  for_message(joined({images.frame_ids.begin(), images.frame_ids.end()})) +
                  ": two drivers publish there; each camera needs a topic of its own");
    InitCamera report;
    report.name = topics.name;
    report.images = images.name;
    report.images_in_source = images.images.size();
    RigCamera camera;
    camera.name = camera.folder = topics.name;
    const auto info = infos.find(topics.name);
    const InfoReading reading =
        info == infos.end() ? camera_of_bag(topics, images) : camera_of_file(info->second, topics.name, images.name);
    for (const std::string& text : reading.notes) note(topics.name + ": " + text);
    plan_.to_undo.push_back(reading.to_undo);
    camera.camera = reading.camera;
    report.camera_info = info == infos.end() ? topics.camera_info : info->second;
    check_image_size(images, camera.camera);
    take_frames(images, &camera);
    report.link = camera.link;
    take_depth(topics, images, sensors, &camera, &report);
    report.width_px = camera.camera.width_px;
    report.height_px = camera.camera.height_px;
    plan_.images.push_back(&images);
    plan_.recording.rig.cameras.push_back(camera);
    plan_.report.cameras.push_back(report);
  }

  InfoReading camera_of_bag(const CameraTopics& topics, const ImageTopic& images) const {
    const std::string expected = namespace_of(images.name) + "/camera_info";
    const std::string remedy = "; give --topic " + topics.name + ".camera_info=TOPIC, or --camera-info " + topics.name +
                               "=FILE with the YAML that camera_calibration writes";
    if (topics.camera_info.empty())
      throw Error("there is no CameraInfo for " + images.name + " (" +
                  (survey_.find_info(expected) == nullptr ? "looked for " + expected
                                                          : expected + " lies beside several cameras") +
                  ")" + remedy);
    const InfoTopic& info = *survey_.find_info(topics.camera_info);
    if (info.changes)
      throw Error(info.name +
                  " changes within the bag: the camera was set up anew; record a bag with one set of "
                  "intrinsics, or give --camera-info " +
                  topics.name + "=FILE");
    try {
      return camera_of_info(info.info, is_rectified(images.name));
    } catch (const Error& error) {
      throw Error(info.name + ": " + error.what() + remedy);
    }
  }

  static void check_image_size(const ImageTopic& images, const Camera& camera) {
    if (images.width == 0 || (images.width == camera.width_px && images.height == camera.height_px)) return;
    throw Error("images of " + images.name + " are " + std::to_string(images.width) + "x" +
                std::to_string(images.height) + ", the intrinsics are of " + std::to_string(camera.width_px) + "x" +
                std::to_string(camera.height_px) + "; record the topic that they belong to");
  }

  std::vector<std::string> robot_frames() const {
    std::vector<std::string> frames = {kGroundFrame, "base_link"};
    if (choice_.odometry != nullptr) frames.push_back(choice_.odometry->child_frame_id);
    if (!options_.robot_frame.empty()) frames.push_back(options_.robot_frame);
    return frames;
  }

  // The images' frame, and the link above it by which the camera is mounted.
  void take_frames(const ImageTopic& images, RigCamera* camera) {
    const FrameTree& tree = survey_.tf_static;
    camera->link = camera->optical_frame = tree.way_up(images.frame_id()).front();
    if (images.frame_id().empty()) {
      camera->link = camera->name;
      note(images.name + ": its headers name no frame; say `link` and `optical_frame` in rig.yaml");
    } else if (!tree.has(images.frame_id())) {
      note(images.name + ": its frame " + for_message(images.frame_id()) +
           " is not in /tf_static, so that the link by which the camera is mounted is unknown; `link` in "
           "rig.yaml is the frame itself");
    } else {
      camera->link = tree.mount_link(images.frame_id(), robot_frames());
      if (camera->link != camera->optical_frame)
        camera->T_link_camera = tree.between(camera->link, camera->optical_frame);
      const std::string& moved = choice_.odometry->child_frame_id;
      if (!tree.between(moved, camera->optical_frame))
        note("/tf_static does not join " + camera->optical_frame + " with " + for_message(moved) + ", which " +
             choice_.odometry->name + " moves: `export` hangs " + camera->link + " on the robot frame itself");
    }
  }

  // -------------------------------------------------------------------------------------------------------- depth

  void take_depth(const CameraTopics& topics, const ImageTopic& images,
                  const std::map<std::string, std::string>& sensors, RigCamera* camera, InitCamera* report) {
    const ImageTopic* depth = topics.depth.empty() ? nullptr : survey_.find_image(topics.depth);
    const auto sensor = sensors.find(topics.name);
    std::optional<SensorPreset> preset;
    if (sensor != sensors.end()) preset = load_sensor_preset(sensor->second);
    if (preset) camera->sensor = sensor->second;
    std::vector<std::string> depth_notes;
    if (depth != nullptr) camera->depth = depth_of_topic(survey_, *depth, images, camera->camera, &depth_notes);
    for (const std::string& text : depth_notes) note(topics.name + ": " + text);
    if (!camera->depth) depth = nullptr;
    if (depth != nullptr && preset && preset->depth) {
      camera->depth->min_m = preset->depth->min_m;
      camera->depth->max_m = preset->depth->max_m;
      camera->depth->noise = preset->depth->noise;
    }
    plan_.depth.push_back(depth);
    if (depth != nullptr) report->depth = depth->name;
    if (depth != nullptr && !preset) without_sensor_.push_back(topics.name);
  }

  // ----------------------------------------------------------------------------------------------------- odometry

  // The robot frame lies on the ground below the frame that odometry moves.
  Rigid3 T_child_robot(const PoseTopic& odometry, const std::string& robot_frame) {
    const std::string& child = odometry.child_frame_id;
    const std::optional<Rigid3> T = survey_.tf_static.between(child, robot_frame);
    if (!T && !options_.robot_frame.empty() && robot_frame != child && survey_.tf_static.has(robot_frame))
      throw Error("--robot-frame " + for_message(robot_frame) + ": /tf_static does not join it with " + child +
                  ", which " + odometry.name + " moves");
    if (!T)
      note("/tf_static has no " + robot_frame + ": it stands for the point on the ground below " + child + ", which " +
           odometry.name + " moves");
    return T.value_or(Rigid3());
  }

  // A few poses that are none are a node's hiccup, many a broken one.
  void check_poses(const PoseTopic& topic) {
    constexpr double kMost = 0.05;
    const BadPoses& bad = topic.bad;
    if (bad.count == 0) return;
    const std::string text = topic.name + ": " + std::to_string(bad.count) + " of " + std::to_string(bad.of) +
                             " poses cannot be used, the first at " + fixed_text(seconds(bad.first_stamp_ns), 3) +
                             " s: " + bad.first;
    if (static_cast<double>(bad.count) > kMost * static_cast<double>(bad.of))
      throw Error(text +
                  ". More than one in twenty is too many: record again with that mended, or take another "
                  "odometry: --topic odometry=TOPIC");
    note(text);
  }

  void take_odometry(const PoseTopic& topic) {
    check_poses(topic);
    InitReport& report = plan_.report;
    report.robot_frame = options_.robot_frame.empty() ? kGroundFrame : options_.robot_frame;
    plan_.recording.rig.robot_frame = report.robot_frame;
    const Rigid3 T = T_child_robot(topic, report.robot_frame);
    std::vector<TimedPose> poses;
    for (const StampedPose& pose : topic.poses) poses.push_back({seconds(pose.stamp_ns), pose.T_odom_child * T});
    GroundTrack track = ground_track(poses);
    report.odometry = topic.name;
    report.odometry_rows = track.odometry.size();
    report.duration_s = track.odometry.back().stamp_s - track.odometry.front().stamp_s;
    report.tilt_deg = track.tilt_deg;
    report.rise_m = track.rise_m;
    if (const std::string text = level_note(topic.name, track); !text.empty()) note(text);
    plan_.recording.odometry = std::move(track.odometry);
  }

  // ------------------------------------------------------------------------------------------------------- clocks

  struct Span {
    double first_s = 0.0, last_s = 0.0;
    bool meets(const Span& other) const { return first_s <= other.last_s && other.first_s <= last_s; }
    std::string text() const { return fixed_text(first_s, 3) + " to " + fixed_text(last_s, 3) + " s"; }
  };

  static Span span_of(const ImageTopic& images) {
    return {seconds(images.images.front().stamp_ns), seconds(images.images.back().stamp_ns)};
  }

  // Throws Error where a camera's stamps never meet those of the odometry.
  std::vector<std::string> notes_of_clocks() const {
    std::vector<std::string> notes;
    const auto& odometry = plan_.recording.odometry;
    const Span driven{odometry.front().stamp_s, odometry.back().stamp_s};
    Problems problems;
    for (std::size_t i = 0; i < plan_.images.size(); ++i) {
      const Span seen = span_of(*plan_.images[i]);
      if (!seen.meets(driven))
        problems.add({"", 0, "camera " + plan_.report.cameras[i].name, "",
                      plan_.images[i]->name + " has stamps from " + seen.text() + ", " + choice_.odometry->name +
                          " from " + driven.text() + clock_remedy(*plan_.images[i])});
      else if (const std::string text = note_of_lag(*plan_.images[i]); !text.empty())
        notes.push_back(text);
    }
    problems.throw_if_any();
    return notes;
  }

  const Clocks* clocks_of(const std::string& topic) const {
    const auto found = survey_.clocks.find(topic);
    return found == survey_.clocks.end() ? nullptr : &found->second;
  }

  std::string clock_remedy(const ImageTopic& images) const {
    const Clocks* camera = clocks_of(images.name);
    const Clocks* wheels = clocks_of(choice_.odometry->name);
    const bool logs_meet = camera != nullptr && wheels != nullptr && camera->first_log_ns <= wheels->last_log_ns &&
                           wheels->first_log_ns <= camera->last_log_ns;
    if (options_.log_stamps || !logs_meet) return ": they never meet; are both of one drive?";
    return ": their headers are of different clocks. Both were recorded at the same time: `--stamps log` takes the "
           "times of "
           "recording instead, late by what messages travel, which does no harm while the robot stands; better set the "
           "driver to the computer's clock";
  }

  // Headers of one clock lag behind the log alike.
  std::string note_of_lag(const ImageTopic& images) const {
    const Clocks* camera = clocks_of(images.name);
    const Clocks* wheels = clocks_of(choice_.odometry->name);
    constexpr double kAlike_s = 0.5;
    if (options_.log_stamps || camera == nullptr || wheels == nullptr) return "";
    const double lag =
        seconds(camera->last_log_ns - camera->last_stamp_ns) - seconds(wheels->last_log_ns - wheels->last_stamp_ns);
    if (std::abs(lag) <= kAlike_s) return "";
    return images.name + ": its headers are " + fixed_text(lag, 2) +
           " s further behind the time of recording than those of " + choice_.odometry->name +
           "; if their clocks differ, `--stamps log` takes the times of recording";
  }

  // ------------------------------------------------------------------------------------------------------- frames

  static std::vector<std::vector<double>> stamps_of(const std::vector<const ImageTopic*>& topics) {
    std::vector<std::vector<double>> stamps_s;
    for (const ImageTopic* images : topics) {
      stamps_s.emplace_back();
      for (const StampedPlace& image : images->images) stamps_s.back().push_back(seconds(image.stamp_ns));
    }
    return stamps_s;
  }

  void keep_frames(const std::vector<std::vector<double>>& stamps_s) {
    const FrameChoice kept =
        choose_frames(stamps_s, plan_.recording.odometry, {options_.every_image, options_.images_per_stop});
    plan_.report.stops = kept.stops;
    plan_.report.moving_images = kept.moving;
    add_notes(choice_notes(kept, options_.images_per_stop));
    for (std::size_t camera = 0; camera < plan_.images.size(); ++camera) keep_frames_of(camera, kept);
  }

  void keep_frames_of(std::size_t camera, const FrameChoice& kept) {
    const ImageTopic& images = *plan_.images[camera];
    InitCamera& report = plan_.report.cameras[camera];
    report.stops = kept.on_the_move ? kept.kept[camera].size() : kept.stops_of_camera[camera];
    const ImageTopic* depth = plan_.depth[camera];
    const DepthPairs pairs = depth == nullptr ? DepthPairs() : pair_depth(images.images, depth->images);
    if (depth != nullptr) note_depth_gap(pairs, *depth, report.name);
    std::vector<CameraFrame> frames;
    for (const std::size_t index : kept.kept[camera]) {
      CameraFrame frame;
      const std::string number = file_number(frames.size());
      frame.stamp_s = seconds(images.images[index].stamp_ns);
      frame.color_file = report.name + "/color/" + number;
      plan_.pictures.push_back({camera, frames.size(), false, images.images[index].place});
      if (depth != nullptr && pairs.nearest[index]) {
        (depth->is_cloud() ? frame.cloud_file : frame.depth_file) =
            report.name + (depth->is_cloud() ? "/cloud/" : "/depth/") + number;
        plan_.pictures.push_back({camera, frames.size(), true, depth->images[*pairs.nearest[index]].place});
      }
      frames.push_back(frame);
    }
    plan_.recording.frames.push_back(std::move(frames));
  }

  void note_depth_gap(const DepthPairs& pairs, const ImageTopic& depth, const std::string& camera) {
    const auto ms = [](double s) { return fixed_text(1e3 * s, 1) + " ms"; };
    const bool any =
        std::any_of(pairs.nearest.begin(), pairs.nearest.end(), [](const auto& one) { return one.has_value(); });
    if (!any)
      note(camera + ": " + depth.name + " is left out: its stamps are " + ms(pairs.least_gap_s) +
           " and more beside those of the images; 20 ms are allowed");
    else if (pairs.largest_gap_s > 1e-3)
      note(camera + ": depth is up to " + ms(pairs.largest_gap_s) +
           " beside its image; each image has the nearest one, which is right while the robot stands");
  }

  const BagSurvey& survey_;
  const InitOptions& options_;
  TopicChoice choice_;
  std::vector<std::string> without_sensor_;
  ImportPlan plan_;
};

}  // namespace

ImportPlan plan_import(const BagSurvey& survey, const InitOptions& options) { return Planner(survey, options).run(); }

}  // namespace rigproof
