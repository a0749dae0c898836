// Odometry of a teleported robot: the truth plus one of the paper's two noises.
#pragma once

#include <cstdint>
#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/core/rig.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

struct OdometrySimulation {
  OdometryModel model = OdometryModel::kPerIncrement;
  double sigma_xy_m = 0.0;     ///< of x and of y
  double sigma_yaw_rad = 0.0;  ///< of yaw
  double scale = 1.0;          ///< per increment: measured over true translation
  double yaw_factor = 1.0;     ///< per increment: measured over true turn
  double rate_hz = 0.0;        ///< samples between the stops; 0 = one sample a stop
};

/// Samples at every stop (exactly at its stamp) and, with a rate, between them; strictly increasing stamps.
///
/// Per pose: every sample is the true pose in the world plus independent N(0, sigma) on x, y and yaw.
/// Per increment, from stop i to i+1, with dp and dtheta the true motion in the world and theta_i the true yaw:
///   m_xy = scale Rz(-theta_i) dp + N(0, sigma_xy I),   m_theta = yaw_factor dtheta + N(0, sigma_yaw),
/// accumulated from (0, 0, 0) at the first stop. Between stops the robot stands for a while, drives one arc of constant
/// twist, and stands again; there a per-increment sample lies on the arc that joins the two measured stops.
/// The noise of stop i comes from the stream (seed, "odometry", i).
std::vector<OdometrySample> simulate_odometry(const std::vector<TrueStop>& stops, const OdometrySimulation& simulation,
                                              std::uint64_t seed);

}  // namespace rigproof
