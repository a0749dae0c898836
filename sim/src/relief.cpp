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

struct HeightAndSlope {
  double height = 0.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};

HeightAndSlope of_ramp(const GroundRelief::Ramp& ramp, const Eigen::Vector2d& p) {
  const Eigen::Vector2d along(std::cos(ramp.heading_rad), std::sin(ramp.heading_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d d = p - Eigen::Vector2d(ramp.x_m, ramp.y_m);
  const Step a = profile(d.dot(along), 0.5 * ramp.level_m, ramp.rise_m);
  const Step b = profile(d.dot(across), 0.5 * ramp.width_m, ramp.rise_m);
  return {ramp.height_m * a.value * b.value,
          ramp.height_m * (a.derivative * b.value * along + a.value * b.derivative * across)};
}

}  // namespace

double GroundRelief::height(const Eigen::Vector2d& p) const {
  double sum = 0.0;
  for (const Wave& wave : waves) sum += wave.amplitude_m * std::cos(wave.wavenumber.dot(p) + wave.phase_rad);
  for (const Ramp& ramp : ramps) sum += of_ramp(ramp, p).height;
  return sum;
}

Eigen::Vector2d GroundRelief::slope(const Eigen::Vector2d& p) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Wave& wave : waves)
    sum -= wave.amplitude_m * std::sin(wave.wavenumber.dot(p) + wave.phase_rad) * wave.wavenumber;
  for (const Ramp& ramp : ramps) sum += of_ramp(ramp, p).slope;
  return sum;
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
