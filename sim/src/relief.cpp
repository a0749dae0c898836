#include "rigproof/sim/relief.h"

#include <algorithm>
#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

constexpr int kWaves = 24;

struct Step {
  double value, derivative;
};

// From 1 to 0 while t goes from 0 to 1, without a kink: 1 - (3 t^2 - 2 t^3).
Step fall(double t) {
  const double u = std::clamp(t, 0.0, 1.0);
  return {1.0 - u * u * (3.0 - 2.0 * u), -6.0 * u * (1.0 - u)};
}

// Profile along one axis: 1 within `half`, falling over `rise` beyond.
Step profile(double s, double half, double rise) {
  const Step step = fall((std::abs(s) - half) / rise);
  return {step.value, (s < 0.0 ? -1.0 : 1.0) * step.derivative / rise};
}

using Surface = GroundRelief::Surface;

Surface of_ramp(const GroundRelief::Ramp& ramp, const Eigen::Vector2d& p) {
  const Eigen::Vector2d along(std::cos(ramp.heading_rad), std::sin(ramp.heading_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d d = p - Eigen::Vector2d(ramp.x_m, ramp.y_m);
  const Step a = profile(d.dot(along), 0.5 * ramp.level_m, ramp.rise_m);
  const Step b = profile(d.dot(across), 0.5 * ramp.width_m, ramp.rise_m);
  return {ramp.height_m * a.value * b.value,
          ramp.height_m * (a.derivative * b.value * along + a.value * b.derivative * across)};
}

Surface endless(const GroundRelief& relief, const Eigen::Vector2d& p) {
  Surface sum;
  for (const GroundRelief::Wave& wave : relief.waves) {
    const double phase = wave.wavenumber.dot(p) + wave.phase_rad;
    sum.height_m += wave.amplitude_m * std::cos(phase);
    sum.slope -= wave.amplitude_m * std::sin(phase) * wave.wavenumber;
  }
  for (const GroundRelief::Ramp& ramp : relief.ramps) {
    const Surface bump = of_ramp(ramp, p);
    sum.height_m += bump.height_m;
    sum.slope += bump.slope;
  }
  return sum;
}

}  // namespace

Surface GroundRelief::at(const Eigen::Vector2d& p) const {
  const Surface whole = endless(*this, p);
  if (!extent) return whole;
  const Step x = profile(p.x() - extent->x_m, extent->half_x_m, extent->fall_m);
  const Step y = profile(p.y() - extent->y_m, extent->half_y_m, extent->fall_m);
  const Eigen::Vector2d fading(x.derivative * y.value, x.value * y.derivative);
  return {x.value * y.value * whole.height_m, x.value * y.value * whole.slope + whole.height_m * fading};
}

std::vector<GroundRelief::Wave> uneven_floor(double sigma_m, double wavelength_m, std::uint64_t seed) {
  std::vector<GroundRelief::Wave> waves;
  if (sigma_m <= 0.0) return waves;
  RandomStream random(seed, "uneven floor");
  for (int i = 0; i < kWaves; ++i) {
    // Equal shares of the variance; a cosine of amplitude a has the variance a^2 / 2.
    GroundRelief::Wave wave;
    wave.amplitude_m = sigma_m * std::sqrt(2.0 / kWaves);
    const double length = wavelength_m * std::exp2(random.uniform(-1.0, 1.0));
    const double direction = kPi * (i + random.uniform()) / kWaves;
    wave.wavenumber = 2.0 * kPi / length * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    wave.phase_rad = random.uniform(0.0, 2.0 * kPi);
    waves.push_back(wave);
  }
  return waves;
}

}  // namespace rigproof
