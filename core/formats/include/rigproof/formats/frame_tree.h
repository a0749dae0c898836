// The static part of a robot's TF. On disk: tf_static.json beside rig.yaml.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/rigid3.h"

namespace rigproof {

class FrameTree {
 public:
  struct Edge {
    std::string parent;
    Rigid3 T_parent_child;
    std::string other_parent;  ///< of a frame that was given two; empty: as it should be
  };

  /// A name may begin with a slash, which tf2 does without. The latest word of a parent counts.
  void add(const std::string& parent, const std::string& child, const Rigid3& T_parent_child);
  /// A transform whose numbers are no pose. Who goes that way gets an Error, unless a good one is added, too.
  void leave_out(const std::string& child, const std::string& why);
  /// "mast: why", of those that no good one stands for.
  std::vector<std::string> left_out() const;
  bool has(const std::string& frame) const;
  bool empty() const { return edges_.empty(); }
  const std::map<std::string, Edge>& edges() const { return edges_; }  ///< by child

  /// The frame, its parent, and so on up to the root. Throws Error for a loop, a frame with two parents, and
  /// one whose transform is left out.
  std::vector<std::string> way_up(const std::string& frame) const;
  /// T_target_source, where both are in one tree.
  std::optional<Rigid3> between(const std::string& target, const std::string& source) const;
  /// The link by which the camera is mounted: the nearest frame above the optical one whose name ends in _link, else
  /// the last one below `robot_frames`, else the optical frame itself.
  std::string mount_link(const std::string& optical, const std::vector<std::string>& robot_frames) const;
  /// The robot's frame on the ground in the tree of `frame`, known by its name: base_footprint, my_robot/footprint.
  std::optional<std::string> ground_frame(const std::string& frame) const;
  /// Of parents and children, each once.
  std::vector<std::string> frames() const;

 private:
  Rigid3 T_above(const std::string& above, const std::string& frame) const;

  std::map<std::string, Edge> edges_;
  std::map<std::string, std::string> left_out_;  // why, by child
};

/// As ROS names optical frames (REP 103): "camera_color_optical_frame".
bool is_optical_name(const std::string& frame);
/// As the user calls it, or made of the link's name; the link itself where that is the optical frame, by its name or
/// because nobody named another one than the camera's own.
std::string optical_frame_name(const std::string& camera, const std::string& link, const std::string& optical_frame);

/// tf_static.json: the transforms as results have them.
std::string frame_tree_text(const FrameTree& tree);
/// Throws Error with every problem.
FrameTree load_frame_tree(const std::filesystem::path& file);
inline constexpr const char* kFrameTreeFile = "tf_static.json";
/// The same of cameras among one another, by their names in rig.yaml, as Kalibr's camchain has them.
inline constexpr const char* kCamchainFile = "camchain.json";

}  // namespace rigproof
