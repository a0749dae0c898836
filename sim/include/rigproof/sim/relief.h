// The shape of a floor that is not flat: unevenness, ramps. Analytic, so that physics and pictures agree on it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
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

  /// A rectangle beyond which the ground is flat.
  struct Extent {
    double x_m = 0.0;  ///< its middle
    double y_m = 0.0;
    double half_x_m = 0.0;  ///< within this the relief is whole
    double half_y_m = 0.0;
    double fall_m = 1.0;  ///< over this it fades out, without a kink
  };

  std::vector<Wave> waves;
  std::vector<Ramp> ramps;
  std::optional<Extent> extent = std::nullopt;  ///< none = everywhere

  bool flat() const { return waves.empty() && ramps.empty(); }
  struct Surface {
    double height_m = 0.0;
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< (dh/dx, dh/dy)
  };
  Surface at(const Eigen::Vector2d& p) const;
  double height(const Eigen::Vector2d& p) const { return at(p).height_m; }
  Eigen::Vector2d slope(const Eigen::Vector2d& p) const { return at(p).slope; }
};

/// The middle of a robot stays in a scene's drivable area, and its wheels within this around it.
inline constexpr double kWheelReach_m = 1.0;

/// Random unevenness: waves of all directions and of lengths from half to twice the given one, whose heights have the
/// given standard deviation over the plane.
std::vector<GroundRelief::Wave> uneven_floor(double sigma_m, double wavelength_m, std::uint64_t seed);

}  // namespace rigproof
