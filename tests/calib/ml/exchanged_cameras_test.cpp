// Folders of two cameras that are exchanged: images, depth and motion go together, and only the lenses tell.
#include <gtest/gtest.h>

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/geometric/geometric.h"
#include "stop_edits.h"
#include "worded.h"

namespace rigproof {
namespace {

// Three cameras of usual doubts, of which the first is as another make's: its lens bends by twelve pixels at the
// corner.
GeometricRun run_of(int seed, double first_k1, int stops = 20) {
  GeometricConfig config;
  config.seed = static_cast<std::uint64_t>(seed);
  config.stops = stops;
  Camera& lens = config.rig.cameras.front().camera;
  lens.lens = Lens::kBrownConrady;
  lens.distortion = {first_k1, 0.0, 0.0, 0.0, 0.0};
  GeometricRun run = draw_geometric_run(config);
  run.observations.board.doubt();
  for (RigCamera& camera : run.observations.cameras) {
    camera.intrinsics_sigma = IntrinsicsSigma();
    camera.depth->noise.doubt_place_and_common_scale();
  }
  return run;
}

void exchange(int first, int second, Observations* observations) {
  for (int stop = 0; stop < static_cast<int>(observations->stops.size()); ++stop)
    ml::swap_frames(stop, first, second, observations);
}

TEST(MlExchangedCameras, AreToldByTheirLenses) {
  for (const int seed : {0, 2}) {
    GeometricRun run = run_of(seed, -0.12);
    EXPECT_EQ(estimate_maximum_likelihood(run.observations, {}).result.status, ResultStatus::kSolved);
    exchange(0, 2, &run.observations);
    const Result result = estimate_maximum_likelihood(run.observations, {}).result;
    ASSERT_EQ(result.status, ResultStatus::kRefused) << seed;
    EXPECT_EQ(result.reasons.front().code, "frames.exchanged") << worded(result.reasons).front();
    EXPECT_EQ(result.reasons.front().cameras, (std::vector<std::string>{"left", "right"}));
  }
}

// A lens that is wrong by as much belongs to no other camera.
TEST(MlExchangedCameras, AreNotBlamedForAWrongLens) {
  GeometricRun run = run_of(1, -0.12, 10);
  for (RigCamera& camera : run.observations.cameras) camera.camera.distortion = {};
  const Result result = estimate_maximum_likelihood(run.observations, {}).result;
  for (const std::vector<Finding>* findings : {&result.reasons, &result.notes})
    for (const Finding& finding : *findings) EXPECT_NE(finding.code, "frames.exchanged");
}

}  // namespace
}  // namespace rigproof
