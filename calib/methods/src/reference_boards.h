// Poses of the board as the authors' program of MEMROC has them.
#pragma once

#include <map>
#include <vector>

#include "rigproof/calib/input/method_input.h"
#include "rigproof/calib/vision/image_files.h"
#include "rigproof/core/result.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::rivals {

/// T_camera_board of one camera by stop; a view whose board is not wholly an inlier is absent.
using BoardPoses = std::map<int, Rigid3>;

struct ReferenceBoards {
  std::vector<BoardPoses> poses;  ///< by camera
  std::vector<CameraUse> use;     ///< by camera
};

/// RANSAC's PnP at 15 px on the corners that reference_chessboards() finds in the recording's images; on the observed
/// ones where there is no image that can be read, and for boards that are no checkerboard, which the program cannot
/// see.
ReferenceBoards reference_boards(const MethodInput& input, const FramesByStop& frames);

}  // namespace rigproof::rivals
