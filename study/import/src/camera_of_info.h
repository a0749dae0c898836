// Intrinsics out of a CameraInfo message.
#pragma once

#include <string>
#include <vector>

#include "rigproof/bags/messages.h"
#include "rigproof/core/camera.h"

namespace rigproof {

struct InfoReading {
  Camera camera;
  std::vector<std::string> notes;  ///< what was approximated or assumed
  /// k1 k2 p1 p2 k3 k4 k5 k6, where no lens of ours meets them: images have to be rectified to be the camera's.
  std::vector<double> to_undo;
};

/// The camera of the images that go with a CameraInfo: K and D, or P without distortion for rectified images, after
/// binning (super-pixels, as the message's definition says) and the region of interest. rational_polynomial is fitted
/// by one of our lenses where that is possible to a quarter of a pixel, else it is to be undone. Throws Error, without
/// the topic's name, for what is no calibration and for lenses that we do not have.
InfoReading camera_of_info(const RosCameraInfo& info, bool rectified);

}  // namespace rigproof
