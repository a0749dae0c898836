// What was found in pictures before, so that a picture that many observations share is searched once.
#pragma once

#include <optional>
#include <string>

#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/image.h"

namespace rigproof {

/// Where observing, and methods that read images, keep what they found in single pictures and between two of them.
/// Everything that a finding depends on is in its key: the content of the pictures, the camera, the board; for planes
/// also where the board and the vertical were; for features where they come from.
class PictureMemory {
 public:
  enum class Finding {
    kCorners,      ///< in an image
    kPlanes,       ///< in a depth image or a cloud: ground and board
    kClouds,       ///< in a depth image or a cloud: the plane that memroc_reference takes
    kChessboards,  ///< in an image: the corners that memroc_reference takes
    kBoardPoses,   ///< of such corners: the pose of the board that memroc_reference takes
    kMatches,      ///< features that two images share
    kMotions,      ///< of the camera between two images, from their matches
    kDepths        ///< in a depth image: what is looked at of it
  };

  static constexpr std::size_t kFindings = 8;

  virtual ~PictureMemory() = default;
  /// A hash of what a file of the recording holds; empty if nobody knows: then nothing is recalled or kept of it.
  virtual std::string content_of(const std::string& file) const = 0;
  /// The bytes that were kept under a key. Called from many threads at once, as keep() is.
  virtual std::optional<std::string> recall(Finding finding, const std::string& key) = 0;
  virtual void keep(Finding finding, const std::string& key, const std::string& bytes) = 0;
  /// Told when observing has to open a file, because its findings are not known.
  virtual void opens(const std::string& /*file*/) {}
};

/// As observe(), to the bit, but pictures that the memory knows are not opened.
Observations observe(const Recording& recording, const ObserveOptions& options, PictureMemory* memory);

/// A frame whose pictures are in memory.
struct FrameInMemory {
  const CameraFrame& files;  ///< in which they would be
  std::size_t camera = 0;
  const Image8& color;   ///< grey or RGB, as its file would be read
  const Image16& depth;  ///< empty = none
};

/// Looks at a frame as observe() does and has the memory keep what it needs of it: observe() opens neither file then.
void look_at(const Recording& recording, const FrameInMemory& frame, PictureMemory* memory);

}  // namespace rigproof
