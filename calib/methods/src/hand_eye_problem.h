// All terms of the MEMROC cost over a set of cameras, their minimum, and its covariance.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Motion of one camera between two of its views: |A X - X B|^2.
struct MotionTerm {
  std::size_t camera;  ///< index among the cameras that are solved
  const ViewPose* from;
  const ViewPose* to;
  double weight = 1.0;  ///< of the robust loss at the minimum
  Vector6d residual = Vector6d::Zero();
};

using Vector12d = Eigen::Matrix<double, 12, 1>;

/// Two cameras that saw the board at the same two stops: |B_j X_jk - X_jk B_k|^2.
struct CameraPairTerm {
  std::size_t camera_j, camera_k;
  const ViewPose *from_j, *to_j, *from_k, *to_k;
  double weight = 1.0;
  Vector12d residual = Vector12d::Zero();  ///< both directions, each times sqrt(1/2)
};

/// Height of the camera over the ground of one frame: (X_z - z)^2.
struct HeightTerm {
  std::size_t camera;
  double height_m;
  double sigma_m;
  double weight = 1.0;
  Eigen::Matrix<double, 1, 1> residual = Eigen::Matrix<double, 1, 1>::Zero();  ///< [m]
};

struct HandEyeProblem {
  std::vector<int> cameras;               ///< indices into Observations::cameras
  std::vector<Rigid3> X;                  ///< T_robot_camera: in the start, out the minimum
  std::vector<Rigid3> odometry;           ///< T_world_robot of every stop
  std::vector<double> depth_scale_sigma;  ///< per solved camera
  std::vector<MotionTerm> motions;
  std::vector<CameraPairTerm> pairs;
  std::vector<HeightTerm> heights;
};

/// Minimises the sum of squares of all terms, metres and radians with equal weights as in the paper, each block under
/// a Cauchy loss whose scale is three times the median of its kind (at least 0.1 mm and 0.1 mrad), so that it bends
/// only at outliers. False if it did not converge.
bool minimise(HandEyeProblem* problem);

/// Covariance of all X together, six rows a camera, chart of transform_error(): the minimum's linear response to the
/// noise of every view's PnP (each view enters two pairs, every pair of cameras and both shares are counted), of the
/// odometry, of the planes and of the depth scale. The odometry's sigmas are those that explain the residuals,
/// and no less than what the user declared.
Eigen::MatrixXd covariance_of(const HandEyeProblem& problem, const OdometryNoise& declared);

}  // namespace rigproof
