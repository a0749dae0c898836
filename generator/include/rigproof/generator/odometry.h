// Odometry of a teleported robot: the truth plus one of several noise models.
#pragma once

#include <cstdint>
#include <vector>

#include "rigproof/core/recording.h"
#include "rigproof/core/rig.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

enum class OdometryLaw {
  kPaper,  ///< per increment or per pose, by `model`
  kThrun,  ///< grows with the motion
  kWheels  ///< wheels that differ from what the driver believes
};

/// var(rot1) = a1 rot1^2 + a2 trans^2, var(trans) = a3 trans^2 + a4 (rot1^2 + rot2^2), var(rot2) = a1 rot2^2 + a2
/// trans^2.
struct ThrunNoise {
  double a1 = 0.0, a2 = 0.0, a3 = 0.0, a4 = 0.0;
};

/// What is true of the wheels, beside what the driver believes.
struct WheelErrors {
  double nominal_track_m = 1.0;  ///< effective track that the driver believes in
  double diameter_ratio = 1.0;   ///< E_d: right over left wheel; their mean is the nominal diameter
  double track_ratio = 1.0;      ///< E_b: true over nominal effective track
  double icr_x_m = 0.0;          ///< the robot turns about the point (icr_x_m, 0) of its frame
  double icr_asymmetry_m = 0.0;  ///< (y_l + y_r) / 2 of the tracks' centres of rotation
  double slip = 0.0;             ///< of either side's way, one sigma, relative
  double way_of_tick_m = 0.0;    ///< 0 = continuous encoders
};

struct OdometrySimulation {
  OdometryLaw law = OdometryLaw::kPaper;
  OdometryModel model = OdometryModel::kPerIncrement;
  double sigma_xy_m = 0.0;     ///< of x and of y
  double sigma_yaw_rad = 0.0;  ///< of yaw
  double scale = 1.0;          ///< per increment: measured over true translation
  double yaw_factor = 1.0;     ///< per increment: measured over true turn
  ThrunNoise thrun;
  WheelErrors wheels;
  double rate_hz = 0.0;  ///< samples between the stops; 0 = one sample a stop
};

/// A motion as a turn on the spot, a straight way, and another turn. Where the first turn would exceed a quarter, the
/// robot drives backwards.
struct TurnDriveTurn {
  double first_rad = 0.0;
  double way_m = 0.0;
  double second_rad = 0.0;

  Rigid3 motion() const;
};
TurnDriveTurn decompose(const Rigid3& T_a_b);

/// Samples at every stop (exactly at its stamp) and, with a rate, between them; strictly increasing stamps.
///
/// Per pose: every sample is the true pose in the world plus independent N(0, sigma) on x, y and yaw.
/// Per increment, from stop i to i+1, with dp and dtheta the true motion in the world and theta_i the true yaw:
///   m_xy = scale Rz(-theta_i) dp + N(0, sigma_xy I),   m_theta = yaw_factor dtheta + N(0, sigma_yaw),
/// accumulated from (0, 0, 0) at the first stop. Thrun and wheels take each motion as turn, drive, turn, and accumulate
/// likewise. Of a side of the wheels with the way w = v -+ omega b / 2 the encoders tell w (1 + slip) D_nominal / D.
/// Between stops the robot stands for a while, drives one arc of constant twist, and stands again; there a sample that
/// accumulates lies on the arc that joins the two measured stops.
/// The noise of stop i comes from the stream (seed, "odometry", i).
std::vector<OdometrySample> simulate_odometry(const std::vector<TrueStop>& stops, const OdometrySimulation& simulation,
                                              std::uint64_t seed);

}  // namespace rigproof
