// Which frames other cameras vouch for, by how the two sit to each other.
#include "pair_agreement.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "rigproof/geometric/geometric.h"
#include "stop_edits.h"

namespace rigproof::ml {
namespace {

Observations drive(GeometricDrive kind = GeometricDrive::kRandom) {
  GeometricConfig config;
  config.seed = 5;
  config.stops = 20;
  config.drive = kind;
  return draw_geometric_run(config).observations;
}

TEST(PairAgreement, VouchesForFramesAsTheyAre) {
  for (const GeometricDrive kind : {GeometricDrive::kRandom, GeometricDrive::kSteps}) {
    const PairAgreement agreement(drive(kind));
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(agreement.vouches_for(c)) << c;
  }
}

TEST(PairAgreement, DoesNotVouchForSwappedFrames) {
  Observations observations = drive();
  swap_frames(7, 0, 2, &observations);
  const PairAgreement agreement(observations);
  for (const int c : {0, 2}) {
    EXPECT_FALSE(agreement.vouches_for(c, 7)) << c;
    EXPECT_TRUE(agreement.vouches_for(c, 8)) << c;
    EXPECT_TRUE(agreement.vouches_for(c)) << c;  // of all other stops
  }
}

// From the first stop on, or from the middle of the drive; small steps, too, move the board by more than poses err.
TEST(PairAgreement, DoesNotVouchForFramesOfOtherStops) {
  for (const GeometricDrive kind : {GeometricDrive::kRandom, GeometricDrive::kSteps})
    for (const int from : {0, 10}) {
      Observations observations = drive(kind);
      shift_cameras({1}, 1, from, &observations);
      const PairAgreement agreement(observations);
      EXPECT_FALSE(agreement.vouches_for(1)) << from;
      EXPECT_TRUE(agreement.vouches_for(0)) << from;
    }
}

// Nobody else sees what it sees.
TEST(PairAgreement, DoesNotVouchForASingleCamera) {
  Observations observations = drive();
  auto& views = observations.board_views;
  views.erase(std::remove_if(views.begin(), views.end(), [](const BoardView& view) { return view.camera > 0; }),
              views.end());
  EXPECT_FALSE(PairAgreement(observations).vouches_for(0));
}

}  // namespace
}  // namespace rigproof::ml
