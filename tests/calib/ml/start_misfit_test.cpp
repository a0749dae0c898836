#include "start_misfit.h"

#include <gtest/gtest.h>

#include <limits>

#include "broken_runs.h"
#include "cases.h"
#include "faults.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof {
namespace {

double misfit_of(const Observations& observations) {
  const MlOptions options;
  return ml::start_misfit(ml::closed_form(observations, options));
}

GeometricConfig drive_of(std::uint64_t seed) {
  GeometricConfig config;
  config.seed = seed;
  config.stops = 16;
  return config;
}

// What undoes a fault of a recording that has none makes it one that has.
TEST(StartMisfit, TellsOdometryThatIsAbsurdFromWhatIsRight) {
  for (const std::uint64_t seed : cases<std::uint64_t>({1, 2, 3, 4})) {
    const Observations right = draw_geometric_run(drive_of(seed)).observations;
    const double of_right = misfit_of(right);
    for (const ml::Fault& fault : ml::odometry_faults(right)) {
      const double of_wrong = misfit_of(undone(fault, right));
      EXPECT_FALSE(ml::is_hopeless(of_right, of_wrong)) << fault.cause.code;
      // The vertical turns with odometry that is mirrored, and everything else with it.
      if (fault.cause.is("odometry.mirrored")) continue;
      EXPECT_TRUE(ml::is_hopeless(of_wrong, of_right)) << fault.cause.code << " " << of_wrong << " of " << of_right;
    }
  }
}

// Ten times the noise of the paper is poor, and no reason not to look.
TEST(StartMisfit, PoorOdometryIsNotHopeless) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const std::uint64_t seed : cases<std::uint64_t>({1, 2, 3, 4})) {
    GeometricConfig config = drive_of(seed);
    config.lambda = 10.0;  // 20 mm and 6 degrees from stop to stop
    const double misfit = misfit_of(draw_geometric_run(config).observations);
    EXPECT_FALSE(ml::is_hopeless(misfit, kInfinity)) << misfit;
  }
}

// The remedy of every fault of the table, as far as it is one of the odometry, is worth a solution.
TEST(StartMisfit, OfABrokenRecordingTheRemedyIsWorthASolution) {
  for (const Breakage& breakage : breakages()) {
    constexpr std::uint64_t kSeed = 2;
    const Observations right = draw_geometric_run(broken_run_config(breakage, kSeed)).observations;
    Observations broken = right;
    breakage.apply(kSeed, &broken);
    EXPECT_FALSE(ml::is_hopeless(misfit_of(right), misfit_of(broken))) << breakage.name;
  }
}

// A robot of twice the size that drives twice as far is judged alike.
TEST(StartMisfit, CountsShiftsAsSharesOfTheWay) {
  Observations observations = draw_geometric_run(drive_of(1)).observations;
  const double misfit = misfit_of(observations);
  observations.board.square_m *= 2.0;
  for (Stop& stop : observations.stops) {
    stop.x_m *= 2.0;
    stop.y_m *= 2.0;
  }
  EXPECT_NEAR(misfit_of(observations), misfit, 0.5);
}

}  // namespace
}  // namespace rigproof
