#include "bag_survey.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <string_view>
#include <utility>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"
#include "ros_pictures.h"
#include "topic_names.h"

namespace rigproof {
namespace {

// "sensor_msgs/Image" of early versions.
std::string full_type(const std::string& type) {
  const std::size_t slash = type.find('/');
  return slash == std::string::npos || type.find("/msg/") != std::string::npos
             ? type
             : type.substr(0, slash) + "/msg" + type.substr(slash);
}

bool is_tf(const BagTopic& topic) { return full_type(topic.type) == kTfType; }

bool is_static(const BagTopic& topic) { return topic.name.find("tf_static") != std::string::npos; }

// Of all that moves, what can be odometry.
bool may_be_odometry(const RosTransform& transform) {
  return transform.header.frame_id.find("odom") != std::string::npos || transform.child_frame_id.rfind("base", 0) == 0;
}

bool same_calibration(const RosCameraInfo& a, const RosCameraInfo& b) {
  return a.width == b.width && a.height == b.height && a.k == b.k && a.d == b.d && a.p == b.p &&
         a.distortion_model == b.distortion_model && a.binning_x == b.binning_x && a.binning_y == b.binning_y &&
         a.roi.x_offset == b.roi.x_offset && a.roi.y_offset == b.roi.y_offset;
}

template <typename Topic>
Topic& topic_named(std::vector<Topic>& topics, const std::string& name) {
  const auto found =
      std::find_if(topics.begin(), topics.end(), [&name](const Topic& topic) { return topic.name == name; });
  if (found != topics.end()) return *found;
  topics.emplace_back();
  topics.back().name = name;
  return topics.back();
}

}  // namespace

class BagSurveyor::Impl {
 public:
  Impl(bool log_stamps, bool with_frames) : log_stamps_(log_stamps), with_frames_(with_frames) {}

  BagSurvey& read_on(Bag& bag) {
    const auto wants = [](const BagTopic& topic) {
      static const std::set<std::string> kWanted = {kImageType, kCompressedImageType, kCameraInfoType, kOdometryType,
                                                    kTfType,    kPointCloudType};
      return topic.encoding == "cdr" && kWanted.count(full_type(topic.type)) > 0;
    };
    bag.read(wants, [&](const BagMessage& message) { take(bag.topics()[message.topic], message); });
    survey_.topics = bag.topics();
    survey_.notes = bag.notes();
    for (ImageTopic& topic : survey_.images) sort_images(topic);
    if (!with_frames_) survey_.tf_static = {};
    for (std::vector<PoseTopic>* topics : {&survey_.odometry, &survey_.tf})
      for (PoseTopic& topic : *topics) sort_poses(topic);
    return survey_;
  }

 private:
  void take(const BagTopic& topic, const BagMessage& message) {
    try {
      dispatch(topic, message);
    } catch (const Error& error) {
      throw Error("topic " + for_message(topic.name) + " (" + for_message(topic.type) + "): a message recorded at " +
                  fixed_text(1e-9 * static_cast<double>(message.log_time_ns), 3) + " s: " + error.what() +
                  ". It is damaged, or not what its type says: record again, or copy the bag without this topic (`ros2 "
                  "bag convert`)");
    }
  }

  void dispatch(const BagTopic& topic, const BagMessage& message) {
    const std::string type = full_type(topic.type);
    if (is_tf(topic)) return take_transforms(topic, message);
    const RosHeader header = read_header(message.data);
    note_clock(topic.name, header.stamp_ns, message.log_time_ns);
    if (type == kImageType || type == kCompressedImageType || type == kPointCloudType)
      take_image(topic.name, type, header, message);
    if (type == kCameraInfoType) take_info(topic.name, message);
    if (type == kOdometryType) take_odometry(topic.name, message);
  }

  std::int64_t stamp_of(const RosHeader& header, const BagMessage& message) const {
    return log_stamps_ ? message.log_time_ns : header.stamp_ns;
  }

  void note_clock(const std::string& topic, std::int64_t stamp_ns, std::int64_t log_ns) {
    const auto [place, is_new] = survey_.clocks.emplace(topic, Clocks{stamp_ns, stamp_ns, log_ns, log_ns});
    Clocks& clocks = place->second;
    clocks.first_stamp_ns = std::min(clocks.first_stamp_ns, stamp_ns);
    clocks.last_stamp_ns = std::max(clocks.last_stamp_ns, stamp_ns);
    clocks.first_log_ns = std::min(clocks.first_log_ns, log_ns);
    clocks.last_log_ns = std::max(clocks.last_log_ns, log_ns);
  }

  void take_image(const std::string& name, const std::string& type, const RosHeader& header,
                  const BagMessage& message) {
    ImageTopic& topic = topic_named(survey_.images, name);
    if (topic.images.empty()) {
      topic.type = type;
      const PictureKind kind = kind_of_picture(type, name, message.data);
      topic.encoding = kind.encoding;
      topic.is_depth = kind.is_depth;
      topic.width = kind.width;
      topic.height = kind.height;
    }
    if (topic.encoding == "32FC1" && !topic.unit_m) topic.unit_m = unit_of_metres(message.data);
    topic.frame_ids.insert(header.frame_id);
    topic.images.push_back({stamp_of(header, message), message.place, std::hash<std::string_view>()(message.data)});
  }

  void take_info(const std::string& name, const BagMessage& message) {
    const RosCameraInfo info = read_camera_info_message(message.data);
    const std::size_t known = survey_.infos.size();
    InfoTopic& topic = topic_named(survey_.infos, name);
    if (survey_.infos.size() > known)
      topic.info = info;
    else
      topic.changes = topic.changes || !same_calibration(topic.info, info);
  }

  void take_odometry(const std::string& name, const BagMessage& message) {
    const RosOdometry odometry = read_odometry_message(message.data);
    PoseTopic& topic = topic_named(survey_.odometry, name);
    if (odometry.no_pose.empty()) {  // a message of zeros has no frames either
      topic.frame_id = odometry.header.frame_id;
      topic.child_frame_id = odometry.child_frame_id;
    }
    take_pose({stamp_of(odometry.header, message), odometry.T_odom_child}, odometry.no_pose, &topic);
  }

  static void take_pose(const StampedPose& pose, const std::string& no_pose, PoseTopic* topic) {
    BadPoses& bad = topic->bad;
    ++bad.of;
    if (no_pose.empty()) return topic->poses.push_back(pose);
    if (bad.count++ > 0) return;
    bad.first_stamp_ns = pose.stamp_ns;
    bad.first = no_pose;
  }

  void take_transforms(const BagTopic& from, const BagMessage& message) {
    for (const RosTransform& transform : read_tf_message(message.data)) {
      if (is_static(from)) {
        take_static(transform);
        continue;
      }
      if (!may_be_odometry(transform)) continue;
      PoseTopic& topic =
          topic_named(survey_.tf, from.name + " " + transform.header.frame_id + " -> " + transform.child_frame_id);
      topic.frame_id = transform.header.frame_id;
      topic.child_frame_id = transform.child_frame_id;
      take_pose({stamp_of(transform.header, message), transform.T_parent_child}, transform.no_pose, &topic);
    }
  }

  void take_static(const RosTransform& transform) {
    if (transform.no_pose.empty())
      survey_.tf_static.add(transform.header.frame_id, transform.child_frame_id, transform.T_parent_child);
    else
      survey_.tf_static.leave_out(transform.child_frame_id, transform.no_pose);
  }

  // Relays and players repeat messages.
  static void sort_images(ImageTopic& topic) {
    const auto key = [](const StampedPlace& one) { return std::pair(one.stamp_ns, one.content); };
    std::stable_sort(topic.images.begin(), topic.images.end(),
                     [&key](const StampedPlace& a, const StampedPlace& b) { return key(a) < key(b); });
    const auto copies = std::unique(topic.images.begin(), topic.images.end(),
                                    [&key](const StampedPlace& a, const StampedPlace& b) { return key(a) == key(b); });
    topic.copies += static_cast<std::size_t>(topic.images.end() - copies);
    topic.images.erase(copies, topic.images.end());
  }

  // A stamp that comes twice says the same: relays and players repeat.
  static void sort_poses(PoseTopic& topic) {
    std::stable_sort(topic.poses.begin(), topic.poses.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns < b.stamp_ns; });
    const auto same = [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns == b.stamp_ns; };
    topic.poses.erase(std::unique(topic.poses.begin(), topic.poses.end(), same), topic.poses.end());
  }

  bool log_stamps_, with_frames_;
  BagSurvey survey_;
};

namespace {

template <typename Topic>
const Topic* find_named(const std::vector<Topic>& topics, const std::string& name) {
  const auto found =
      std::find_if(topics.begin(), topics.end(), [&name](const Topic& topic) { return topic.name == name; });
  return found == topics.end() ? nullptr : &*found;
}

}  // namespace

const ImageTopic* BagSurvey::find_image(const std::string& topic) const { return find_named(images, topic); }
const InfoTopic* BagSurvey::find_info(const std::string& topic) const { return find_named(infos, topic); }

BagSurveyor::BagSurveyor(bool log_stamps, bool with_frames) : impl_(std::make_unique<Impl>(log_stamps, with_frames)) {}
BagSurveyor::~BagSurveyor() = default;
const BagSurvey& BagSurveyor::read_on(Bag& bag) { return impl_->read_on(bag); }

BagSurvey survey_bag(Bag& bag, bool log_stamps, bool with_frames) {
  return BagSurveyor(log_stamps, with_frames).read_on(bag);
}

}  // namespace rigproof
