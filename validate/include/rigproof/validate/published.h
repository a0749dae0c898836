// The numbers that the paper published, to stand beside one's own.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/validate/validate.h"

namespace rigproof {

/// One row of the paper's tables: mean absolute error, tx ty tz [cm], rx ry rz [deg] (roll, pitch, yaw). Absent where
/// the method gives none.
struct PublishedRow {
  std::string method;
  std::array<std::optional<double>, 6> error;
};

struct PublishedTable {
  std::string title;
  bool between_cameras = false;
  bool synthetic = true;  ///< 10 runs of 100 poses; else the real robot
  std::vector<PublishedRow> rows;
};

/// The three tables: synthetic camera to robot, synthetic camera to camera, real robot camera to camera.
const std::vector<PublishedTable>& published_tables();

/// Mean over the cameras (or pairs) of the absolute error per axis in cm and deg, in the chart of transform_error() or,
/// as the paper reads rotations, as roll, pitch and yaw. Absent without any.
std::optional<std::array<double, 6>> mean_absolute_error(const std::vector<TransformError>& errors,
                                                         bool as_roll_pitch_yaw);

}  // namespace rigproof
