#include "rigproof/study/report/noise_curve.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/generator/sensors.h"
#include "rigproof/study/report/figures.h"

namespace rigproof {
namespace {

constexpr int kCurvePoints = 200;
// Looked at beside those that are spread over the range: a run's proof tells its noise there, too.
constexpr double kRoundDistancesM[] = {0.8, 1.0, 2.0, 4.0};

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

std::string csv_line(double z_m, double law_m, double recorded_m, const std::optional<double>& simulated_m,
                     const std::optional<double>& mean_error_m) {
  const auto mm = [](const std::optional<double>& metres) { return metres ? short_text(1e3 * *metres, 6) : ""; };
  return short_text(z_m, 6) + "," + mm(law_m) + "," + mm(recorded_m) + "," + mm(simulated_m) + "," + mm(mean_error_m) +
         "\n";
}

}  // namespace

std::vector<NoisePoint> measure_noise(const SensorDevice& device, int count) {
  const DepthSensing model = depth_sensing_of(device);
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

std::string noise_csv(const SensorDevice& device, const std::vector<NoisePoint>& points) {
  const DepthSensing model = depth_sensing_of(device);
  std::string csv = "z_m,law_mm,recorded_mm,simulated_mm,mean_error_mm\n";
  for (int i = 0; i <= kCurvePoints; ++i) {
    const double z = model.stream.min_m + (model.stream.max_m - model.stream.min_m) * i / kCurvePoints;
    csv += csv_line(z, model.stream.noise.sigma_m(z), model.recorded_sigma_m(z), {}, {});
  }
  for (const NoisePoint& point : points)
    csv += csv_line(point.z_m, point.law_m, point.recorded_m, point.realised_m, point.mean_error_m);
  return csv;
}

void write_noise_curve(const SensorDevice& device, const std::vector<NoisePoint>& points,
                       const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  if (extension != ".png" && extension != ".pdf" && extension != ".svg")
    throw Error(file.string() + ": a figure's name must end in .png, .pdf or .svg");
  double worst = 0.0;
  for (const NoisePoint& point : points) worst = std::max(worst, std::abs(point.realised_m / point.recorded_m - 1.0));
  const std::filesystem::path csv = std::filesystem::path(file).replace_extension(".csv");
  write_file_atomically(csv, noise_csv(device, points));
  draw_figures("noise", csv,
               {"--formats", extension.substr(1), "--title",
                "Depth noise of " + device.preset.name + ": " + device.preset.description + "; simulated within " +
                    short_text(100.0 * worst, 2) + " % of the law with rounding"});
}

}  // namespace rigproof
