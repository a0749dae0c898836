// Odometry between its samples.
#pragma once

#include <optional>
#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/recording.h"

namespace rigproof::detection {

/// The robot's pose at some time by odometry.
struct OdometryReading {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double sigma_m = 0.0;     ///< of the interpolation
  double odometer_m = 0.0;  ///< length of the path since the first sample, turns counted as kTurnLever metres a radian
};

/// Interpolates along arcs of constant twist.
class OdometryTrack {
 public:
  /// A turn of one radian moves a camera on the robot about this far [m].
  static constexpr double kTurnLever = 0.3;

  /// @param samples by strictly increasing stamp
  /// @param nearest_s a sample this close serves where there are no two samples to interpolate between
  OdometryTrack(const std::vector<OdometrySample>& samples, double max_gap_s, double nearest_s);

  /// The pose at a stamp, or nothing and why.
  std::optional<OdometryReading> at(double stamp_s, Finding* why_not) const;
  /// Velocity in the robot's frame [m/s, m/s, rad/s], between the samples beside the stamp; zero where the robot stands
  /// or they are too far apart.
  Eigen::Vector3d velocity_at(double stamp_s) const;
  /// How the velocity changes around a stamp [m/s^2, m/s^2, rad/s^2]: of the parabola through the samples within 60 ms.
  /// Zero where there are fewer than five, where the robot stands, and where a wild one makes it more than wheels can
  /// do.
  Eigen::Vector3d acceleration_at(double stamp_s) const;
  /// Samples (x, y, yaw) between two readings of the odometry, thinned: arcs of constant twist between those that are
  /// kept pass the others within 1 mm and 1 mrad. Ends are exact, and a yaw factor moves what lies between by a few per
  /// cent of that.
  std::vector<Eigen::Vector3d> way(const Stop& from, const Stop& to) const;

 private:
  OdometryReading sample(std::size_t index) const;
  OdometryReading interpolated(std::size_t before, double stamp_s) const;
  Eigen::Vector3d velocity(std::size_t before) const;

  const std::vector<OdometrySample>& samples_;
  std::vector<double> odometer_m_;
  double max_gap_s_;
  double nearest_s_;
};

}  // namespace rigproof::detection
