// The shape of a floor that is not flat: unevenness, ramps. Analytic, so that physics and pictures agree on it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace rigproof {

/// Height of the ground over the plane z = 0 of the world, which stays the reference. Empty = flat.
class GroundRelief {
 public:
  /// One of the waves that unevenness is made of: amplitude cos(k . p + phase).
  struct Wave {
    double amplitude_m = 0.0;
    Eigen::Vector2d wavenumber = Eigen::Vector2d::Zero();  ///< [rad/m]
    double phase_rad = 0.0;
  };
  /// A bump across the way: rises over `rise_m`, stays level, and falls again, with rounded ends.
  struct Ramp {
    double x_m = 0.0;  ///< middle of the level part
    double y_m = 0.0;
    double heading_rad = 0.0;  ///< direction in which it rises and falls
    double height_m = 0.0;
    double level_m = 0.5;  ///< length of the level part
    double rise_m = 1.0;   ///< horizontal length of either slope
    double width_m = 2.0;  ///< across; the sides fall over `rise_m`, too
  };

  std::vector<Wave> waves;
  std::vector<Ramp> ramps;

  bool flat() const { return waves.empty() && ramps.empty(); }
  double height(const Eigen::Vector2d& p) const;
  /// (dh/dx, dh/dy).
  Eigen::Vector2d slope(const Eigen::Vector2d& p) const;
};

/// Random unevenness: waves of all directions and of lengths from half to twice the given one, whose heights have the
/// given standard deviation over the plane.
std::vector<GroundRelief::Wave> uneven_floor(double sigma_m, double wavelength_m, std::uint64_t seed);

}  // namespace rigproof
