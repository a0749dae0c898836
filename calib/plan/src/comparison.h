// Two sets of poses of the same cameras, each with what is known about it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/result.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::moved {

/// Poses of cameras in the robot. All matrices have six rows a camera, in the chart of transform_error().
struct KnownPoses {
  std::vector<Rigid3> T_robot_camera;
  Eigen::MatrixXd covariance;       ///< without the free directions
  Eigen::MatrixXd free_directions;  ///< that nothing determines, one a column
  /// What the data would add to the poses, to first order; empty = nothing.
  Eigen::VectorXd step;
  /// Of the poses that they are compared with, where errors that last count in these; empty: as those know it.
  Eigen::MatrixXd covariance_before = {};
  /// Errors that the other observations meet again.
  std::optional<LastingErrors> lasting = std::nullopt;
};

/// Six columns: errors of all cameras when the rig moves as one body along and about the robot's axes.
Eigen::MatrixXd rig_motion(const std::vector<Rigid3>& T_robot_camera);
/// Orthonormal columns that span what is at right angles to the given ones.
Eigen::MatrixXd complement(const Eigen::MatrixXd& directions);
/// The motion of the rig as one body between two sets of poses; a few cameras that moved by themselves take no part.
Rigid3 common_motion(const std::vector<Rigid3>& before, const std::vector<Rigid3>& now);

/// New less old poses as far as both determine them. With M the information about the difference, `gradient` = M d, a
/// shift E delta of some cameras explains g' A^+ g of the statistic d' M d, with A = E' M E and g = E' M d.
struct Difference {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  double statistic = 0.0;
  int rank = 0;
  std::vector<Rigid3> T_robot_camera;  ///< the new poses, without the common motion
};
Difference difference(const KnownPoses& before, const KnownPoses& now);

/// The best shift along the columns of E.
struct Explanation {
  double reduction = 0.0;  ///< of the statistic
  int rank = 0;            ///< directions of the shift that the data determine
  Eigen::VectorXd shift;
  Eigen::MatrixXd covariance;
  Eigen::MatrixXd undetermined;  ///< directions of the shift, one a column
};
Explanation explain(const Difference& difference, const Eigen::MatrixXd& E);

}  // namespace rigproof::moved
