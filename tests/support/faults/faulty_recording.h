// A recording to break: a folder that shares every file with the healthy one until a fault replaces it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <set>
#include <string>
#include <vector>

#include "rigproof/core/random.h"
#include "rigproof/core/recording.h"

namespace rigproof::faults {

class FaultyRecording {
 public:
  /// @param run a run's folder: `recording` below it is linked into `folder`, and what the same drive would have
  /// recorded
  ///        after a change lies beside it, in run-VARIANT
  /// @param seed tells faults which camera and which frames to break
  FaultyRecording(std::filesystem::path run, const std::filesystem::path& folder, std::uint64_t seed);

  /// As it is by now.
  const Recording& now() const { return recording_; }
  const std::filesystem::path& folder() const { return recording_.folder; }
  std::size_t cameras() const { return recording_.rig.cameras.size(); }
  RandomStream random(const char* purpose, std::int64_t frame = -1) const { return {seed_, purpose, frame}; }

  /// A camera to break, which the seed chooses among those for which this holds; throws std::logic_error if it holds
  /// for none.
  std::size_t camera_with(const std::function<bool(const RigCamera&)>& holds);
  std::size_t any_camera();
  std::size_t depth_camera();
  /// The cameras that were chosen to be broken; none where a fault is not of single cameras.
  const std::set<std::string>& broken() const { return broken_; }

  void edit_rig(const std::function<void(Rig*)>& edit);
  void edit_odometry(const std::function<void(std::vector<OdometrySample>*)>& edit);
  void edit_odometry_text(const std::function<std::string(const std::string&)>& edit);
  /// frames.csv of a camera.
  void edit_frames(std::size_t camera, const std::function<void(std::vector<CameraFrame>*)>& edit);

  using EditImage = std::function<void(std::size_t frame, cv::Mat* image)>;
  /// Every image of a camera, 8 bit as it is stored.
  void edit_color(std::size_t camera, const EditImage& edit);
  /// Every depth image of a camera, 16 bit.
  void edit_depth(std::size_t camera, const EditImage& edit);
  /// The depth images of a camera as clouds, each point p as move(p), in metres in the colour camera's frame.
  void depth_to_clouds(std::size_t camera, const std::function<Eigen::Vector3f(const Eigen::Vector3f&)>& move);

  /// Puts the bytes of another file in the place of one; both relative to the recording.
  void replace(const std::string& file, const std::string& by);
  /// What the same drive recorded of this file after a change.
  void replace_by_variant(const std::string& file, const std::string& variant);
  /// Frame i gets the image, or the depth image, of frame source(i) of a camera; all as they were before.
  void rearrange(std::size_t camera, std::string CameraFrame::*which,
                 const std::function<std::size_t(std::size_t)>& source);

 private:
  std::filesystem::path run_;
  std::uint64_t seed_;
  Recording recording_;
  std::set<std::string> broken_;
};

}  // namespace rigproof::faults
