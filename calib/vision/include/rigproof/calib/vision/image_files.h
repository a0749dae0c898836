// The image that represents a camera at a stop, for methods that read images besides the observations.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "rigproof/core/image.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"

namespace rigproof::rivals {

/// Frames by (stop, camera).
using FramesByStop = std::map<std::pair<int, int>, const CameraFrame*>;

/// The frame that observing chose where the board was seen, else the first one of the stop. The recording must outlive
/// what is returned.
FramesByStop frames_by_stop(const Observations& observations, const Recording& recording);

/// The frame, or none.
const CameraFrame* frame_of(const FramesByStop& frames, int stop, int camera);

/// A frame's image, or nothing where it cannot be read or is not of the camera's size.
std::optional<Image8> readable_image(const Recording& recording, const CameraFrame& frame, const Camera& camera);

}  // namespace rigproof::rivals
