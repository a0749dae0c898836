// What is left when the calibration carries the board from view to view.
#pragma once

#include "inspect_pictures.h"

namespace rigproof::inspect_detail {

struct CarriedOver {
  std::vector<Residual> residuals;  ///< reprojected minus detected [px]
  std::size_t from_same_stop = 0;   ///< views that another camera's view was carried to
  std::size_t from_other_stops = 0;
};
/// Of each view of a camera, through the lenses and with the board that the result estimated. Empty where the result
/// does not have the camera's pose.
CarriedOver carried_over(const Observations& observations, const Result& result, std::size_t camera);

}  // namespace rigproof::inspect_detail
