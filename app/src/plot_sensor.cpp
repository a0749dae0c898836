// `rigproof sensors --plot NAME`.
#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "json_text.h"
#include "rigproof/study/report/noise_curve.h"
#include "terminal.h"

namespace rigproof {

int plot_sensor_command(const PlotSensorArguments& arguments) {
  std::string name = arguments.name;
  // People write D455, files are called d455.
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  const SensorDevice device = load_sensor_device(name);
  const std::filesystem::path file = arguments.output.empty() ? name + "_noise.png" : arguments.output.string();
  const std::vector<NoisePoint> points = measure_noise(device);
  write_noise_curve(device, points, file);
  if (arguments.common.json) {
    nlohmann::json json = {{"sensor", name}, {"picture", file.string()}, {"points", nlohmann::json::array()}};
    for (const NoisePoint& point : points)
      json["points"].push_back({{"z_m", point.z_m},
                                {"law_mm", 1e3 * point.law_m},
                                {"recorded_mm", 1e3 * point.recorded_m},
                                {"realised_mm", 1e3 * point.realised_m},
                                {"mean_error_mm", 1e3 * point.mean_error_m}});
    std::puts(json_text(json).c_str());
    return 0;
  }
  const Terminal terminal(arguments.common.quiet);
  terminal.line("  z [m]   law [mm]   with rounding   simulated   mean error");
  for (const NoisePoint& point : points)
    terminal.line(fmt::format("{:7.2f} {:10.3f} {:15.3f} {:11.3f} {:+12.3f}", point.z_m, 1e3 * point.law_m,
                              1e3 * point.recorded_m, 1e3 * point.realised_m, 1e3 * point.mean_error_m));
  terminal.line("picture    " + file.string());
  return 0;
}

}  // namespace rigproof
