// Odometry along the way between two stops: effect of its scale, its yaw factor and its noise on the end.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rigproof/calib/estimate/noise.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// A wrong yaw factor bends the path: a turn measured too large rotates everything after it. Hence the path is
/// integrated again for every factor, in arcs of constant twist.
class OdometryWay {
 public:
  /// The way to `to` from the previous stop; a single arc if its samples are unknown.
  /// @param point_m of the robot whose way it is, in its frame: the one whose motion the wheels tell, since scale and
  /// yaw factor are errors of that
  OdometryWay(const Stop& from, const Stop& to, const Eigen::Vector2d& point_m);
  const Eigen::Vector2d& point_m() const { return point_m_; }

  /// Motion to the end of the way in the frame of its start, without what the measured heading veers by with every
  /// metre forward [rad/m], and with turns of 1 / yaw_factor times what remains: x, y [m], yaw as it remains, full
  /// turns included.
  struct Motion {
    Eigen::Vector3d value;
    Eigen::Vector2d xy_by_yaw_factor;
    Eigen::Vector3d by_veer;
  };
  Motion motion(double yaw_factor, double veer = 0.0) const;

  /// Covariances of the motion's error for unit levels: translation noise of 1 m after a way of 1 m, and heading noise
  /// of 1 rad after a turn of 1 rad, or after the way that loses as much; it bends the path after it. Both are random
  /// walks.
  const Eigen::Matrix3d& noise_of_translation() const { return translation_; }
  Eigen::Matrix3d noise_of_heading(const OdometryLaw& law) const {
    return turning_ + law.metre_as_turn_rad * straying_;
  }

 private:
  struct Arc {
    Eigen::Vector2d way;  // along the arc, straightened: x, y in the frame of its beginning
    double turn;
  };
  void add_noise();

  std::vector<Arc> arcs_;
  Eigen::Vector2d point_m_;
  double length_m_ = 0.0;
  Eigen::Matrix3d translation_, turning_, straying_;
};

/// A motion from one stop to the next: x, y, yaw in the frame of its beginning, and its derivative by a veer that is
/// taken out of it.
struct VeeringIncrement {
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();
  Eigen::Vector3d by_veer = Eigen::Vector3d::Zero();
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();  ///< of the robot whose motion it is, in its frame
};

/// Covariance of the measured motion's error.
struct WayNoise {
  Eigen::Matrix3d whitening;  ///< lower triangular: whitening * covariance * whitening' = 1
  Eigen::Matrix3d heading;    ///< share of the heading's noise in the whitened covariance; the rest is translation's
};
WayNoise way_noise(const OdometryWay& way, const NoiseLevels& levels, const Stop& from, const Stop& to);

/// Levels per increment with the same mean variances over the observed ways as the levels along the way.
NoiseLevels per_increment(const NoiseLevels& along_way, const Observations& observations);

}  // namespace rigproof::ml
