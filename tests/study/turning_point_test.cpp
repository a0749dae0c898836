// A robot on skidding wheels that carries a load off its middle, from the files of its recording: no data tell about
// which point it turns, so that this is in the uncertainty.
#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/generator/generate.h"
#include "rigproof/study/sweep/run_config.h"
#include "rigproof/truth/truth.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

// On the spot it turns about a point so far ahead of its middle.
constexpr double kAhead_m = 0.13;

class LoadedRobot : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    GenerateOptions options;
    options.output = *folder_ / "run";
    options.jobs = 2;
    generate(run_config("", {"rig=husky_3x_d455", "motion=drive", "poses=12", "image_scale=0.5", "seed=5",
                             "drive.payload_kg=15", "drive.payload_x_m=0.25"}),
             options);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static Observations observed() { return observe(load_recording(RunFolder{*folder_ / "run"}.recording())); }
  // Of every camera's x, signed, in metres and in what is stated of it.
  struct OffAlongX {
    double most_m = 0.0, in_sigmas = 0.0;
  };
  static OffAlongX off_along_x(const Result& result) {
    const Truth truth = load_truth(RunFolder{*folder_ / "run"}.truth_file());
    OffAlongX off;
    for (const TrueCamera& camera : truth.cameras) {
      const EstimatedTransform* found = result.find("base_footprint", camera.name);
      if (found == nullptr || !found->fully_observable() || !found->covariance) {
        ADD_FAILURE() << camera.name << " is not solved";
        continue;
      }
      const double off_m = found->T_parent_child.translation.x() - camera.T_robot_camera.translation.x();
      if (std::abs(off_m) > std::abs(off.most_m)) off = {off_m, off_m / std::sqrt((*found->covariance)(0, 0))};
    }
    return off;
  }

  static TempFolder* folder_;
};
TempFolder* LoadedRobot::folder_ = nullptr;

TEST_F(LoadedRobot, OfWhichNothingIsSaidIsAsUncertainAsItIsWrong) {
  const OffAlongX off = off_along_x(estimate_maximum_likelihood(observed()).result);
  EXPECT_NEAR(off.most_m, -kAhead_m, 0.03);
  EXPECT_LT(std::abs(off.in_sigmas), 4.0);
}

// The fault that the prior is there for.
TEST_F(LoadedRobot, ThatIsSaidToTurnAboutItsAxleIsWrong) {
  Observations observations = observed();
  observations.odometry_noise.rotation_centre_sigma_m = 0.005;
  EXPECT_GT(std::abs(off_along_x(estimate_maximum_likelihood(observations).result).in_sigmas), 5.0);
}

// As on the floor it was measured.
TEST_F(LoadedRobot, OfWhichThePointIsStatedIsRight) {
  Recording recording = load_recording(RunFolder{*folder_ / "run"}.recording());
  recording.rig.odometry_noise.rotation_centre_m << kAhead_m, 0.0;
  recording.rig.odometry_noise.rotation_centre_sigma_m = 0.01;
  const OffAlongX off = off_along_x(estimate_maximum_likelihood(observe(recording)).result);
  EXPECT_LT(std::abs(off.most_m), 0.03);
  EXPECT_LT(std::abs(off.in_sigmas), 3.0);
}

}  // namespace
}  // namespace rigproof
