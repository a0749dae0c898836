// The best accuracy that the data of a run allow: the Cramer-Rao bound, evaluated at the truth.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

/// One standard deviation of an axis, in the chart of transform_error(), metres and radians; the largest of all
/// transforms. Absent where the data leave the axis of one of them open.
using AxisBounds = std::array<std::optional<double>, 6>;

struct DataBound {
  AxisBounds camera_to_robot;
  AxisBounds camera_to_camera;  ///< all absent with a single camera
};

/// The same for a single transform, in the order of the truth's cameras and pairs as a Comparison has them.
struct TransformBound {
  std::string parent;  ///< "robot" or a camera, which may be called so, too
  std::string child;
  AxisBounds sigma;
  bool is_in_robot = false;
};

/// One entry for each camera of the observations, then for each pair. Empty where data_bound() would be absent.
std::vector<TransformBound> transform_bounds(const Observations& observations, const Truth& truth);

/// The largest of these; absent if there are none.
std::optional<DataBound> largest_of(const std::vector<TransformBound>& bounds);

/// The bound of these observations of the run: corners and planes with their stated covariances, the odometry with the
/// noise that was drawn. Absent if a camera or a stop of the observations is not in the truth.
std::optional<DataBound> data_bound(const Observations& observations, const Truth& truth);

/// "The data allow tx .091 ty .13 tz .0026 cm, rx .0008 ry .0009 rz .024 deg (1 sigma); between cameras .013 cm, .0013
/// deg." and a newline.
std::string format_bound(const DataBound& bound);

}  // namespace rigproof
