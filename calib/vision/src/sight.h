// The findings in one picture of a recording, and the bytes in which they are kept.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rig.h"

namespace rigproof::detection {

/// One image of the recording and what came of it.
struct Sight {
  int stop = 0;
  int camera = 0;
  int frame = 0;
  bool readable = false;  ///< the image has the right size
  bool wrong_size = false;
  std::vector<CornerObservation> corners;
  std::optional<Finding> why_not;  ///< why there are no corners
  int board = 0;                   ///< which of the rig's boards the corners are of
};

/// Depth of one image.
struct PlaneSight {
  std::optional<PlaneObservation> ground;
  std::optional<PlaneObservation> board;
  std::optional<Finding> why_not;  ///< why there is no ground plane
};

/// Findings without their place in the recording. Every bit of a number is kept.
std::string bytes_of(const Sight& sight);
std::string bytes_of(const PlaneSight& planes);
/// False if the bytes are no such finding.
bool read_bytes(const std::string& bytes, Sight* sight);
bool read_bytes(const std::string& bytes, PlaneSight* planes);

/// Hash of all that corners depend on.
std::string corners_key(const std::string& content, const Camera& camera, const Board& board,
                        const std::vector<Board>& others);
/// Hash of all that planes depend on. `points` is the number of depth points that are looked at.
std::string planes_key(const std::string& content, const RigCamera& camera, const Board& board, int points,
                       const std::optional<Rigid3>& T_camera_board, const std::optional<Eigen::Vector3d>& up_camera);

}  // namespace rigproof::detection
