// Planes of clouds as the authors' program of MEMROC has them.
#pragma once

#include <optional>

#include "rigproof/calib/input/method_input.h"
#include "rigproof/calib/vision/image_files.h"
#include "rigproof/calib/vision/reference_cloud_plane.h"

namespace rigproof::rivals {

/// Whether any camera has clouds, or depth images of a known kind.
bool has_clouds(const Observations& observations, const Recording& recording);

/// Where planes come from.
class PlaneSource {
 public:
  virtual ~PlaneSource() = default;
  /// The plane that a camera saw at a stop, if any.
  virtual std::optional<CloudPlane> at(int stop, int camera) const = 0;
};

/// largest_plane() of each cloud, or of a depth image thinned as `convert` does it for the program. None where neither
/// can be read.
class CloudPlanes : public PlaneSource {
 public:
  /// Both must outlive it; the input has a recording.
  CloudPlanes(const MethodInput& input, const FramesByStop& frames) : input_(input), frames_(frames) {}
  std::optional<CloudPlane> at(int stop, int camera) const override;

 private:
  const MethodInput& input_;
  const FramesByStop& frames_;
};

/// The observed planes, fitted with the sensor's noise.
class ObservedPlanes : public PlaneSource {
 public:
  /// They must outlive it.
  explicit ObservedPlanes(const std::vector<PlaneObservation>& planes) : planes_(planes) {}
  std::optional<CloudPlane> at(int stop, int camera) const override;

 private:
  const std::vector<PlaneObservation>& planes_;
};

}  // namespace rigproof::rivals
