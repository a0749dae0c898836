// Observations as the factors take them: whitened by their stated covariances, once.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/core/observations.h"

namespace rigproof::ml {

struct WhitenedView {
  struct Corner {
    Eigen::Vector3d point_board;
    Eigen::Vector2d pixel;
    Eigen::Matrix2d whitening;
  };
  int stop, camera;
  double after_stop_s;  ///< by the stamps; 0 where the robot stands
  std::vector<Corner> corners;
};

struct WhitenedPlane {
  int stop, camera;
  double after_stop_s;
  Eigen::Vector3d measured;
  Eigen::Matrix3d whitening;
  bool registered;  ///< errs with the intrinsics
};

/// One for each board view, without corners whose covariance is of no use.
std::vector<WhitenedView> whitened_views(const Observations& observations);
/// @param biases added to the planes' covariances [1/m^2]; empty: none
std::vector<WhitenedPlane> whitened_planes(const Observations& observations,
                                           const std::vector<PlaneObservation>& planes,
                                           const std::vector<Eigen::Matrix3d>& biases);

}  // namespace rigproof::ml
