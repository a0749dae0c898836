// Sensor presets: the shipped ones have sources, impossible values are told all at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "error_text.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/files.h"
#include "rigproof/core/rig_yaml.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

/// Data of the test's own, found through RIGPROOF_DATA.
class OwnData : public TempFolder {
 public:
  OwnData() { setenv("RIGPROOF_DATA", path().c_str(), 1); }
  ~OwnData() { unsetenv("RIGPROOF_DATA"); }
};

TEST(SensorPresets, EveryNumberThatIsSimulatedSaysWhereItIsFrom) {
  for (const std::string& name : list_presets("sensors")) {
    std::istringstream in(read_text_file(find_data_file("sensors", name)));
    bool simulation = false;
    for (std::string line; std::getline(in, line);) {
      if (line.rfind("simulation:", 0) == 0) simulation = true;
      const bool number = line.rfind("    ", 0) == 0 && line.find(": ") != std::string::npos;
      if (!simulation || !number || line.find("gamma: 2.2") != std::string::npos) continue;
      EXPECT_TRUE(line.find("# source:") != std::string::npos || line.find("# assumed") != std::string::npos)
          << name << ": " << line;
    }
    EXPECT_TRUE(simulation) << name;
  }
}

TEST(SensorPresets, TwoImagersAreABaselineApart) {
  for (const char* name : {"d455", "d435"}) {
    const SensorPreset preset = load_sensor_preset(name);
    const std::vector<double>& imagers = preset.simulation.depth.imagers_x_m;
    ASSERT_EQ(imagers.size(), 2U);
    EXPECT_NEAR(imagers[1] - imagers[0], preset.stereo->baseline_m, 1e-12) << name;
  }
}

TEST(SensorPresets, ImpossibleValuesAreToldAllAtOnce) {
  const OwnData folder;
  folder.write("models/sensors/broken.yaml", R"(color:
  {width_px: 640, height_px: 480, hfov_deg: 190}
depth:
  min_m: 3
  max_m: 2
  stereo: {width_px: 640, hfov_deg: 80, baseline_m: -0.1, disparity_sigma_px: 0.08}
simulation:
  color: {full_well_electrons: -5, gama: 2.2}
  depth: {patchy_share: 0.7, ripple_share: 0.6, flying_share: 1.5}
)");
  const std::string error = error_text([] { load_sensor_preset("broken"); });
  for (const char* part :
       {"broken.yaml:2: color.hfov_deg: 190", "depth.min_m: 3: must be less than max_m",
        "depth.stereo.baseline_m: -0.1", "simulation.color.full_well_electrons: -5", "simulation.color.gama", "gamma",
        "simulation.depth.patchy_share: 0.7: ", "simulation.depth.flying_share: 1.5: allowed is 0 to 1"})
    EXPECT_THAT(error, HasSubstr(part));
}

}  // namespace
}  // namespace rigproof
