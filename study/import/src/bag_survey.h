// What a bag holds, found in one pass: everything but the pictures themselves, of which it is known where they lie.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "rigproof/bags/bag.h"
#include "rigproof/bags/messages.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/formats/frame_tree.h"

namespace rigproof {

struct StampedPlace {
  std::int64_t stamp_ns = 0;  ///< of the header, or of the log
  BagPlace place;
  std::size_t content = 0;  ///< a hash of the message
};

struct ImageTopic {
  std::string name;
  std::string type;
  std::set<std::string> frame_ids;
  std::string encoding;              ///< of the first picture; "png", "jpeg" or "compressedDepth" for compressed ones
  bool is_depth = false;             ///< clouds are, too
  int width = 0, height = 0;         ///< of the first picture
  std::optional<double> unit_m;      ///< of depth in metres: unit_of_metres()
  std::vector<StampedPlace> images;  ///< by stamp
  std::size_t copies = 0;            ///< messages of a stamp and content that were there already; left out of them

  bool is_compressed() const { return type == kCompressedImageType; }
  bool is_cloud() const { return type == kPointCloudType; }
  const std::string& frame_id() const { return *frame_ids.begin(); }
};

struct InfoTopic {
  std::string name;
  RosCameraInfo info;  ///< the first
  bool changes = false;
};

struct StampedPose {
  std::int64_t stamp_ns = 0;
  Rigid3 T_odom_child;
};

/// Poses of a topic that are none.
struct BadPoses {
  std::size_t count = 0;
  std::size_t of = 0;  ///< messages of the topic
  std::int64_t first_stamp_ns = 0;
  std::string first;  ///< why it is none
};

struct PoseTopic {
  std::string name;  ///< "/odom", or "/tf odom -> base_link"
  std::string frame_id, child_frame_id;
  std::vector<StampedPose> poses;  ///< by stamp, each once
  BadPoses bad;                    ///< left out of them
};

/// Header against log of one topic [s].
struct Clocks {
  std::int64_t first_stamp_ns = 0, last_stamp_ns = 0, first_log_ns = 0, last_log_ns = 0;
};

struct BagSurvey {
  std::vector<BagTopic> topics;
  std::vector<std::string> notes;  ///< of the bag: how it was read
  std::vector<ImageTopic> images;
  std::vector<InfoTopic> infos;
  std::vector<PoseTopic> odometry;  ///< of nav_msgs/Odometry
  std::vector<PoseTopic> tf;        ///< moving transforms that may be odometry
  FrameTree tf_static;
  std::map<std::string, Clocks> clocks;  ///< by topic

  const ImageTopic* find_image(const std::string& topic) const;
  const InfoTopic* find_info(const std::string& topic) const;
};

/// @param log_stamps the time of recording stands for the headers' stamps
/// @param with_frames false: what /tf_static says is left alone
/// Throws Error that names the topic.
BagSurvey survey_bag(Bag& bag, bool log_stamps, bool with_frames = true);

/// The same of a bag that grows.
class BagSurveyor {
 public:
  explicit BagSurveyor(bool log_stamps, bool with_frames = true);
  ~BagSurveyor();
  BagSurveyor(const BagSurveyor&) = delete;
  BagSurveyor& operator=(const BagSurveyor&) = delete;

  /// With what has come since the last call; as survey_bag() of the whole bag. Throws Error, after which it is of no
  /// use.
  const BagSurvey& read_on(Bag& bag);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigproof
