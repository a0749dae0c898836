// Pictures of a data set and of what a calibration made of it.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"
#include "rigproof/formats/format.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

struct InspectInput {
  Input input;  ///< images are drawn where it has a recording; observations alone will do
  Observations observations;
  std::optional<Truth> truth;
  std::vector<Result> results;
};

struct InspectOptions {
  int mosaic_views = 4;         ///< of each camera in the mosaic
  int max_excluded_views = 24;  ///< excluded frames that are shown; all of them are counted
};

/// Writes PNG pictures into `folder`, each whole or not at all, and returns their paths in the order of this list:
///   mosaic.png            a few views of every camera with their corners
///   coverage.png          where in the images of each camera corners were seen
///   drive.png             top view: stops, headings, odometry (and truth), board, frusta
///   rig.png               the robot with its cameras in three dimensions, as estimated (ml, else the first result) and
///                         as they truly are, errors and 2-sigma ellipsoids drawn larger by a factor that is told
///   corners_CAMERA.png    detected against true corners, magnified (with truth)
///   corners_METHOD_CAMERA.png        detected corners against the boards that fit best (without truth)
///   reprojection_METHOD_CAMERA.png   corners as the result carries them over from another view, against the detected
///   excluded.png          frames left out, with the reasons
/// A picture that would show nothing is not written. An image that cannot be read is drawn as an empty frame that
/// says so. Throws Error where a picture cannot be written.
std::vector<std::filesystem::path> write_pictures(const InspectInput& input, const std::filesystem::path& folder,
                                                  const InspectOptions& options = {});

}  // namespace rigproof
