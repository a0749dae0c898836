#include "bag_import.h"

#include <algorithm>
#include <map>

#include "clock_check.h"
#include "depth_of_bag.h"
#include "ground_track.h"
#include "import_words.h"
#include "rig_files.h"
#include "rigproof/core/error.h"
#include "rigproof/core/rig_yaml.h"
#include "rigproof/core/text.h"
#include "robot_frame.h"
#include "topic_names.h"

namespace rigproof {
namespace {

void append(const std::vector<std::string>& notes, std::vector<std::string>* to) {
  to->insert(to->end(), notes.begin(), notes.end());
}

std::vector<std::string> notes_of_choice(const TopicChoice& choice, const BagSurvey& survey) {
  std::vector<std::string> notes = choice.notes;
  for (const std::string& text : survey.tf_static.left_out()) notes.push_back("/tf_static: left out is " + text);
  return notes;
}

// --------------------------------------------------------------------------------------------------------- cameras

void check_image_size(const ImageTopic& images, const Camera& camera) {
  if (images.width == 0 || (images.width == camera.width_px && images.height == camera.height_px)) return;
  throw Error("images of " + images.name + " are " + std::to_string(images.width) + "x" +
              std::to_string(images.height) + ", the intrinsics are of " + std::to_string(camera.width_px) + "x" +
              std::to_string(camera.height_px) + "; record the topic that they belong to");
}

// The cameras of a plan, one after the other.
class CameraPlanner {
 public:
  CameraPlanner(const BagSurvey& survey, const InitOptions& options, const PoseTopic& odometry,
                const std::string& robot_frame)
      : survey_(survey), options_(options), odometry_(odometry), robot_frame_(robot_frame) {}

  // Images, depth and what to undo of each camera, its entry in rig and report, and notes.
  ImportPlan run(const std::vector<CameraTopics>& cameras) {
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
    if (!copies_.empty())
      note("images that came again, with the same stamp and content, are left out: " + joined(copies_));
    if (!without_sensor_.empty())
      note("depth of " + joined(without_sensor_) +
           " is taken for that of a common stereo camera; say what it is: --sensor d455, or `sensor: d455` "
           "below each in rig.yaml (`rigproof sensors` lists them)");
    return std::move(plan_);
  }

 private:
  void note(const std::string& text) { plan_.report.notes.push_back(text); }

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
    for (const ImageTopic* topic : {&images, plan_.depth.back()})
      if (topic != nullptr && topic->copies > 0)
        copies_.push_back(std::to_string(topic->copies) + " of " + topic->name);
    report.width_px = camera.camera.width_px;
    report.height_px = camera.camera.height_px;
    plan_.images.push_back(&images);
    plan_.recording.rig.cameras.push_back(camera);
    plan_.report.cameras.push_back(report);
  }

  InfoReading camera_of_bag(const CameraTopics& topics, const ImageTopic& images) const {
    const std::string expected = namespace_of(images.name) + "/camera_info";
    const std::string remedy = "; give --topic " + topics.name + ".camera_info=TOPIC, or --camera-info " + topics.name +
                               "=FILE with the YAML that camera_calibration writes; if it is no camera: --topic " +
                               topics.name + "=none";
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

  std::vector<std::string> robot_frames() const {
    return {"base_footprint", "base_link", odometry_.child_frame_id, robot_frame_};
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
      const std::string& moved = odometry_.child_frame_id;
      if (!tree.between(robot_frame_, camera->optical_frame) && !tree.between(moved, camera->optical_frame))
        note("/tf_static does not join " + camera->optical_frame + " with " +
             (moved.empty() ? for_message(robot_frame_) : for_message(moved) + ", which " + odometry_.name + " moves") +
             ": `export` hangs " + camera->link + " on the robot frame itself");
    }
  }

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

  const BagSurvey& survey_;
  const InitOptions& options_;
  const PoseTopic& odometry_;
  const std::string& robot_frame_;
  std::vector<std::string> without_sensor_, copies_;
  ImportPlan plan_;
};

// -------------------------------------------------------------------------------------------------------- odometry

// A few poses that are none are a node's hiccup, many a broken one. Empty where there are none.
std::string note_of_bad_poses(const PoseTopic& topic) {
  constexpr double kMost = 0.05;
  const BadPoses& bad = topic.bad;
  if (bad.count == 0) return "";
  const std::string text = topic.name + ": " + std::to_string(bad.count) + " of " + std::to_string(bad.of) +
                           " poses cannot be used, the first at " + fixed_text(seconds(bad.first_stamp_ns), 3) +
                           " s: " + bad.first;
  if (static_cast<double>(bad.count) > kMost * static_cast<double>(bad.of))
    throw Error(text +
                ". More than one in twenty is too many: record again with that mended, or take another "
                "odometry: --topic odometry=TOPIC");
  return text;
}

GroundTrack track_of(const PoseTopic& topic, const Rigid3& T_child_robot) {
  std::vector<TimedPose> poses;
  for (const StampedPose& pose : topic.poses)
    poses.push_back({seconds(pose.stamp_ns), pose.T_odom_child * T_child_robot});
  return ground_track(poses);
}

// Says in the report what was read.
std::vector<OdometrySample> odometry_of(const PoseTopic& topic, const Rigid3& T_child_robot, InitReport* report) {
  const GroundTrack track = track_of(topic, T_child_robot);
  report->odometry = topic.name;
  report->odometry_rows = track.odometry.size();
  report->duration_s = track.odometry.back().stamp_s - track.odometry.front().stamp_s;
  report->tilt_deg = track.tilt_deg;
  report->rise_m = track.rise_m;
  if (const std::string text = level_note(topic.name, track); !text.empty()) report->notes.push_back(text);
  return track.odometry;
}

// ---------------------------------------------------------------------------------------------------------- frames

std::vector<std::vector<double>> stamps_of(const std::vector<const ImageTopic*>& topics) {
  std::vector<std::vector<double>> stamps_s;
  for (const ImageTopic* images : topics) {
    stamps_s.emplace_back();
    for (const StampedPlace& image : images->images) stamps_s.back().push_back(seconds(image.stamp_ns));
  }
  return stamps_s;
}

// Empty where depth lies well beside its images.
std::string depth_gap_note(const DepthPairs& pairs, const std::string& depth, const std::string& camera) {
  const auto ms = [](double s) { return fixed_text(1e3 * s, 1) + " ms"; };
  const bool any =
      std::any_of(pairs.nearest.begin(), pairs.nearest.end(), [](const auto& one) { return one.has_value(); });
  if (!any)
    return camera + ": " + depth + " is left out: its stamps are " + ms(pairs.least_gap_s) +
           " and more beside those of the images; 20 ms are allowed";
  if (pairs.largest_gap_s > 1e-3)
    return camera + ": depth is up to " + ms(pairs.largest_gap_s) +
           " beside its image; each image has the nearest one, which is right while the robot stands";
  return "";
}

// The frames of one camera, and its pictures in the plan.
std::vector<CameraFrame> frames_of(std::size_t camera, const std::vector<std::size_t>& kept, const DepthPairs& pairs,
                                   ImportPlan* plan) {
  const ImageTopic& images = *plan->images[camera];
  const ImageTopic* depth = plan->depth[camera];
  const std::string& folder = plan->recording.rig.cameras[camera].folder;
  std::vector<CameraFrame> frames;
  for (const std::size_t index : kept) {
    CameraFrame frame;
    const std::string number = file_number(frames.size());
    frame.stamp_s = seconds(images.images[index].stamp_ns);
    frame.color_file = folder + "/color/" + number;
    plan->pictures.push_back({camera, frames.size(), false, images.images[index].place});
    if (depth != nullptr && pairs.nearest[index]) {
      (depth->is_cloud() ? frame.cloud_file : frame.depth_file) =
          folder + (depth->is_cloud() ? "/cloud/" : "/depth/") + number;
      plan->pictures.push_back({camera, frames.size(), true, depth->images[*pairs.nearest[index]].place});
    }
    frames.push_back(frame);
  }
  return frames;
}

void keep_frames_of(std::size_t camera, const FrameChoice& kept, ImportPlan* plan) {
  InitCamera& report = plan->report.cameras[camera];
  report.stops = kept.on_the_move ? kept.kept[camera].size() : kept.stops_of_camera[camera];
  DepthPairs pairs;
  if (const ImageTopic* depth = plan->depth[camera]; depth != nullptr) {
    pairs = pair_depth(plan->images[camera]->images, depth->images);
    if (const std::string text = depth_gap_note(pairs, depth->name, report.name); !text.empty())
      plan->report.notes.push_back(text);
  }
  plan->recording.frames.push_back(frames_of(camera, kept.kept[camera], pairs, plan));
}

}  // namespace

bool takes_frames(const InitOptions& options) {
  return std::find(options.topics.begin(), options.topics.end(), "tf_static=none") == options.topics.end();
}

ImportPlan plan_import(const BagSurvey& survey, const InitOptions& options) {
  const TopicChoice choice = choose_topics(survey, topic_rules(options.topics));
  const PoseTopic& odometry = *choice.odometry;
  const RobotFrame robot = robot_frame_of(survey.tf_static, odometry, options.robot_frame);
  ImportPlan plan = CameraPlanner(survey, options, odometry, robot.name).run(choice.cameras);
  Recording& recording = plan.recording;
  InitReport& report = plan.report;
  recording.rig.name = options.output.filename().string();
  if (options.board) recording.rig.board = *options.board;
  std::vector<std::string> of_choice = notes_of_choice(choice, survey);
  append(robot.notes, &of_choice);
  report.notes.insert(report.notes.begin(), of_choice.begin(), of_choice.end());
  if (const std::string text = note_of_bad_poses(odometry); !text.empty()) report.notes.push_back(text);
  report.robot_frame = recording.rig.robot_frame = robot.name;
  recording.odometry = odometry_of(odometry, robot.T_child_robot, &report);
  append(notes_of_clocks(survey, options.log_stamps, odometry.name, plan), &report.notes);
  check_stamps_differ(plan, options.log_stamps);
  const FrameChoice kept =
      choose_frames(stamps_of(plan.images), recording.odometry, {options.every_image, options.images_per_stop});
  report.stops = kept.stops;
  report.moving_images = kept.moving;
  append(choice_notes(kept, options.images_per_stop), &report.notes);
  for (std::size_t camera = 0; camera < plan.images.size(); ++camera) keep_frames_of(camera, kept, &plan);
  return plan;
}

}  // namespace rigproof
