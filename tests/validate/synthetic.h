// A small rig whose truth is known, and results and data made from it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/core/observations.h"
#include "rigproof/core/random.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/result.h"
#include "rigproof/truth/truth.h"

namespace rigproof::testing_support {

/// Camera frame at a place in the robot frame, looking along yaw (0 = forward, left positive), tilted down.
Rigid3 looking(const Eigen::Vector3d& place_m, double yaw_deg, double down_deg, double roll_deg = 0.0);

/// Three cameras (left, center, right), a board, and `stops` stops in front of it.
Truth make_truth(std::size_t stops = 12);

/// The truth as a result, every camera displaced by `error` in the chart of transform_error().
Result make_result(const Truth& truth, const std::vector<Vector6d>& errors);
Result exact_result(const Truth& truth);

/// A random symmetric positive definite matrix whose standard deviations are near the given ones.
Eigen::MatrixXd random_covariance(const Eigen::VectorXd& sigmas, RandomStream& random);
/// A draw from N(0, covariance).
Eigen::VectorXd draw(const Eigen::MatrixXd& covariance, RandomStream& random);

/// Corners of every board view that is whole in an image, as the truth projects them, with noise.
Observations make_observations(const Truth& truth, double sigma_px, std::uint64_t seed = 1);

/// A recording whose depth images show board and ground as the truth has them.
struct DepthFaults {
  bool along_ray = false;
  double factor = 1.0;
  bool mirrored_y = false;
  double noise_sigmas = 0.0;
  double bow_m = 0.0;      ///< the middle of the board stands out towards the viewer, bent about the board's y
  bool furniture = false;  ///< something stands on the ground in the left quarter: its foot meets the ground's depth
};
/// z of a board's face that is bent so, at x [m].
double bowed_z_m(const Board& board, double bow_m, double x_m);
Recording make_depth_recording(const Truth& truth, const std::filesystem::path& folder, const DepthFaults& faults);

}  // namespace rigproof::testing_support
