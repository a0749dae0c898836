#include "rigproof/study/noise_curve.h"

#include <algorithm>
#include <cmath>

#include "inspect_canvas.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/sensors.h"

namespace rigproof {
namespace {

using namespace inspect_detail;

constexpr int kWidth = 960, kHeight = 600;
constexpr double kLeft = 84.0, kRight = 28.0, kTop = 118.0, kBottom = 64.0;
constexpr int kCurvePoints = 200;
// Looked at beside those that are spread over the range: a run's proof tells its noise there, too.
constexpr double kRoundDistancesM[] = {0.8, 1.0, 2.0, 4.0};
constexpr Color kLaw{0, 114, 178}, kRounded{213, 94, 0};

NoisePoint measure_wall(const DepthSensing& model, double z_m) {
  constexpr int kWallWidth = 640, kWallHeight = 480;
  SensorModel sensor_model;
  sensor_model.depth = model;
  const Sensor sensor(sensor_model, kWallWidth, kWallHeight);
  // A few units oblique, so that rounding falls everywhere between two steps.
  ImageF wall(kWallWidth, kWallHeight);
  for (int y = 0; y < kWallHeight; ++y)
    for (int x = 0; x < kWallWidth; ++x)
      wall.at(x, y) = static_cast<float>(z_m + 20.0 * model.stream.unit_m * (x - kWallWidth / 2) / kWallWidth);
  Image16 counts;
  sensor.sense_depth(wall, Image8(), model.stream.unit_m, {0, std::lround(1000.0 * z_m), 0}, &counts);
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < counts.pixels.size(); ++i) {
    if (counts.pixels[i] == 0) continue;
    const double error = counts.pixels[i] * model.stream.unit_m - static_cast<double>(wall.pixels[i]);
    sum += error;
    squares += error * error;
    ++count;
  }
  NoisePoint point{z_m, model.stream.noise.sigma_m(z_m), model.recorded_sigma_m(z_m), 0.0, 0.0};
  if (count < 2.0) return point;
  point.mean_error_m = sum / count;
  point.realised_m = std::sqrt(std::max(0.0, squares / count - point.mean_error_m * point.mean_error_m));
  return point;
}

// Where numbers lie in the picture.
struct Axes {
  double z_end = 1.0, sigma_end_mm = 1.0;

  Eigen::Vector2d at(double z_m, double sigma_mm) const {
    return {kLeft + (kWidth - kLeft - kRight) * z_m / z_end,
            kHeight - kBottom - (kHeight - kTop - kBottom) * sigma_mm / sigma_end_mm};
  }
};

void draw_grid(const Axes& axes, Canvas* canvas) {
  const double z_step = round_step(axes.z_end / 5.0), sigma_step = round_step(axes.sigma_end_mm / 5.0);
  for (double z = 0.0; z <= axes.z_end * 1.0001; z += z_step) {
    canvas->line(axes.at(z, 0.0), axes.at(z, axes.sigma_end_mm), kRule);
    canvas->text(axes.at(z, 0.0) + Eigen::Vector2d(0.0, 22.0), number(z), 11.0, kGrey, Align::kCentre);
  }
  for (double sigma = 0.0; sigma <= axes.sigma_end_mm * 1.0001; sigma += sigma_step) {
    canvas->line(axes.at(0.0, sigma), axes.at(axes.z_end, sigma), kRule);
    canvas->text(axes.at(0.0, sigma) + Eigen::Vector2d(-10.0, 4.0), number(sigma), 11.0, kGrey, Align::kRight);
  }
  canvas->text({kWidth - kRight, kHeight - 16.0}, "distance [m]", 12.0, kInk, Align::kRight);
  canvas->text({kLeft - 60.0, kTop - 14.0}, "standard deviation of depth [mm]", 12.0, kInk);
}

void draw_legend(Canvas* canvas) {
  const double y = kTop + 22.0, x = kLeft + 26.0;
  canvas->line({x, y - 4.0}, {x + 30.0, y - 4.0}, kLaw, 2.0);
  canvas->text({x + 40.0, y}, "the preset's law", 12.0, kInk);
  canvas->line({x, y + 18.0}, {x + 30.0, y + 18.0}, kRounded, 2.0);
  canvas->text({x + 40.0, y + 22.0}, "with the rounding of disparity and unit", 12.0, kInk);
  canvas->disc({x + 15.0, y + 40.0}, 4.5, kInk);
  canvas->text({x + 40.0, y + 44.0}, "simulated walls of 640 x 480 pixels", 12.0, kInk);
}

}  // namespace

std::vector<NoisePoint> measure_noise(const SensorPreset& preset, int count) {
  const DepthSensing model = depth_sensing_of(preset);
  // A wall at the very ends of the range loses pixels beyond it.
  const double near = 1.15 * model.stream.min_m, far = 0.92 * model.stream.max_m;
  std::vector<double> distances_m;
  for (int i = 0; i < count; ++i) distances_m.push_back(near + (far - near) * i / std::max(1, count - 1));
  for (const double z_m : kRoundDistancesM)
    if (z_m > near && z_m < far) distances_m.push_back(z_m);
  std::sort(distances_m.begin(), distances_m.end());
  std::vector<NoisePoint> points;
  for (const double z_m : distances_m) points.push_back(measure_wall(model, z_m));
  return points;
}

void write_noise_curve(const SensorPreset& preset, const std::filesystem::path& file) {
  const DepthSensing model = depth_sensing_of(preset);
  const std::vector<NoisePoint> points = measure_noise(preset);
  const double end_m = model.stream.max_m;
  Axes axes;
  axes.z_end = round_up(end_m);
  axes.sigma_end_mm = round_up(1050.0 * model.recorded_sigma_m(end_m));
  std::vector<Eigen::Vector2d> law, rounded;
  double worst = 0.0;
  for (int i = 0; i <= kCurvePoints; ++i) {
    const double z = model.stream.min_m + (end_m - model.stream.min_m) * i / kCurvePoints;
    law.push_back(axes.at(z, 1000.0 * model.stream.noise.sigma_m(z)));
    rounded.push_back(axes.at(z, 1000.0 * model.recorded_sigma_m(z)));
  }
  for (const NoisePoint& point : points) worst = std::max(worst, std::abs(point.realised_m / point.recorded_m - 1.0));
  Canvas canvas(kWidth, kHeight);
  draw_title(&canvas, "Depth noise of " + preset.name,
             preset.description + "; simulated within " + short_text(100.0 * worst, 2) + " % of the law with rounding");
  draw_grid(axes, &canvas);
  canvas.polyline(rounded, kRounded, 2.0, false);
  canvas.polyline(law, kLaw, 2.0, false);
  for (const NoisePoint& point : points) canvas.disc(axes.at(point.z_m, 1000.0 * point.realised_m), 4.5, kInk);
  draw_legend(&canvas);
  canvas.save(file);
}

}  // namespace rigproof
