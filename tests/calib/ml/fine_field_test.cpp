// What no polynomial follows of a lens: as large as said, and its size is found from what is left of corners.
#include "fine_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fine_level.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/preparation.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof::ml {
namespace {

const Camera kCamera = Camera::symmetric(1280, 720, 640.0);
constexpr int kCells = 8;

TEST(MlFineField, SharesAddUpToOneEverywhere) {
  const FineField field(kCamera, kCells);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(1279.5, 719.5),
                                       Eigen::Vector2d(640.0, 360.0), Eigen::Vector2d(2000.0, -300.0)}) {
    double sum = 0.0;
    for (const FineField::Share& share : field.at(pixel)) {
      ASSERT_GE(share.node, 0);
      ASSERT_LT(share.node, field.nodes());
      EXPECT_GE(share.weight, 0.0);
      sum += share.weight;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

TEST(MlFineField, IsAsLargeAsSaid) {
  const FineField field(kCamera, kCells);
  double variance = 0.0;
  int points = 0;
  for (int x = 0; x < kCamera.width_px; x += 7)
    for (int y = 0; y < kCamera.height_px; y += 7, ++points)
      for (const FineField::Share& share : field.at({x, y})) variance += share.weight * share.weight;
  EXPECT_NEAR(std::sqrt(variance / points), FineField::kRms, 0.01);
}

// Boards here and there in the image, whose corners a field displaces: the rows of their views.
class Drawn {
 public:
  Drawn(double node_sigma_px, double noise_px, RandomStream* random, int cells = kCells, int corners = 48)
      : field_(kCamera, cells), corners_(corners) {
    Eigen::VectorXd nodes(field_.size());
    for (double& node : nodes) node = random->normal(0.0, node_sigma_px);
    for (int view = 0; view < 60; ++view) add_view(nodes, noise_px, random);
  }
  double sigma_px(double prior_px) const { return level(prior_px, kCells).sigma_px; }
  FineLevel level(double prior_px, int cells) const {
    std::vector<LeftOver> left;
    for (std::size_t v = 0; v < views_.size(); ++v) left.push_back({&views_[v], views_[v].residual, weights_[v]});
    return fine_level(left, FineField(kCamera, cells), LensField(kCamera), prior_px);
  }

  // Every twentieth corner: far off and without weight, or of no use to begin with.
  void leave_out(bool far_off) {
    for (std::size_t v = 0; v < views_.size(); ++v)
      for (int row = 0; row < 2 * corners_; row += 40) {
        if (far_off) {
          views_[v].residual.segment<2>(row).array() += 50.0;
          weights_[v].segment<2>(row).setZero();
        } else {
          views_[v].residual.segment<2>(row).setZero();
          views_[v].by_pose.middleRows<2>(row).setZero();
          views_[v].whitening[static_cast<std::size_t>(row / 2)].setZero();
        }
      }
  }

 private:
  void add_view(const Eigen::VectorXd& nodes, double noise_px, RandomStream* random) {
    const int columns = std::min(8, corners_ - 1);  // never all in a line
    const Eigen::Vector2d corner(random->uniform(0.0, 900.0), random->uniform(0.0, 450.0));
    ViewRows rows{0, 0, {}, Eigen::VectorXd(2 * corners_), Eigen::MatrixXd::Zero(2 * corners_, 6), {}, {}, {}, {}};
    for (int i = 0; i < corners_; ++i) {
      const Eigen::Vector2d place = 50.0 * Eigen::Vector2d(i % columns, i / columns);
      rows.pixels.emplace_back(corner + place);
      rows.whitening.emplace_back(Eigen::Matrix2d::Identity() / noise_px);
      Eigen::Vector2d displaced(random->normal(0.0, noise_px), random->normal(0.0, noise_px));
      for (const FineField::Share& share : field_.at(rows.pixels.back()))
        displaced += share.weight * nodes.segment<2>(2 * share.node);
      rows.residual.segment<2>(2 * i) = displaced / noise_px;
      rows.by_pose.block<2, 2>(2 * i, 0).setIdentity();
      rows.by_pose.block<2, 4>(2 * i, 2) << place.x(), place.y(), 0, 0, 0, 0, place.x(), place.y();
    }
    weights_.emplace_back(Eigen::VectorXd::Ones(2 * corners_));
    views_.push_back(std::move(rows));
  }

  FineField field_;
  int corners_;
  std::vector<ViewRows> views_;
  std::vector<Eigen::VectorXd> weights_;
};

TEST(MlFineField, ItsSizeIsFoundWhereCornersTellIt) {
  double found = 0.0;
  constexpr int kFields = 6;
  for (int seed = 0; seed < kFields; ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "fine field");
    found += Drawn(0.3, 0.05, &random).sigma_px(0.1) / kFields;
  }
  EXPECT_NEAR(found, 0.3, 0.04);
}

// A grid that is too coarse makes up for it by size; what the corners find likelier tells them apart.
TEST(MlFineField, TheLikeliestGridIsTheFieldsOwn) {
  for (const auto& [own, other] : {std::pair(8, 16), std::pair(16, 8)}) {
    double found = 0.0, by_other = 0.0;
    constexpr int kFields = 4;
    for (int seed = 0; seed < kFields; ++seed) {
      RandomStream random(static_cast<std::uint64_t>(seed), "fine field");
      const Drawn drawn(0.3, 0.05, &random, own);
      const FineLevel with_own = drawn.level(0.1, own), with_other = drawn.level(0.1, other);
      EXPECT_GT(with_own.log_evidence, with_other.log_evidence + 10.0) << own << " cells, seed " << seed;
      found += with_own.sigma_px / kFields;
      by_other += with_other.sigma_px / kFields;
    }
    EXPECT_NEAR(found, 0.3, 0.06) << own;
    EXPECT_GT(std::abs(by_other - 0.3), 0.08) << own;
  }
}

// Splines that do not fit make up for a field by numbers that are large where no corner is. What corners are displaced
// by is as large as the field all the same.
TEST(MlFineField, WhatCornersShowIsAsLargeAsTheFieldOnAnyGrid) {
  double on_own = 0.0, on_coarser = 0.0, numbers_of_coarser = 0.0;
  constexpr int kFields = 6;
  for (int seed = 0; seed < kFields; ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), "fine field");
    const Drawn drawn(0.3, 0.01, &random, 16);
    const FineLevel own = drawn.level(0.3, 16), coarser = drawn.level(0.3, 12);
    on_own += own.shown_px / kFields;
    on_coarser += coarser.shown_px / kFields;
    numbers_of_coarser += coarser.sigma_px / kFields;
  }
  EXPECT_NEAR(on_own, 0.3, 0.04);
  EXPECT_NEAR(on_coarser, 0.3, 0.1);
  EXPECT_GT(numbers_of_coarser, 0.9);  // three times the field: suspicions cannot go by it
}

TEST(MlFineField, WithoutOneNoneIsFound) {
  RandomStream random(7, "fine field");
  EXPECT_LT(Drawn(0.0, 0.05, &random).sigma_px(0.1), 0.02);
}

// Root mean square of sizes whose logarithm is Student's t, as far as they are tried.
constexpr double kOfPrior = 1.168;

TEST(MlFineField, WhereCornersTellNothingThePriorStands) {
  RandomStream random(8, "fine field");
  EXPECT_NEAR(Drawn(0.1, 20.0, &random).sigma_px(0.1), 0.1 * kOfPrior, 0.005);
}

// Three corners a view, which poses of six numbers follow wherever they are.
TEST(MlFineField, ViewsThatTheirPosesFollowTellNothing) {
  RandomStream random(9, "fine field");
  const FineLevel level = Drawn(0.3, 0.05, &random, kCells, 3).level(0.1, kCells);
  EXPECT_NEAR(level.sigma_px, 0.1 * kOfPrior, 0.005);
  EXPECT_NEAR(level.log_evidence, 0.0, 0.01);
}

TEST(MlFineField, CornersWithoutWeightAreNotThere) {
  RandomStream random(10, "fine field");
  Drawn far_off(0.3, 0.05, &random);
  Drawn of_no_use = far_off;
  const double with_all = far_off.level(0.1, kCells).log_evidence;
  far_off.leave_out(true);
  of_no_use.leave_out(false);
  const FineLevel level = far_off.level(0.1, kCells), without = of_no_use.level(0.1, kCells);
  EXPECT_NEAR(level.sigma_px, without.sigma_px, 1e-9);
  EXPECT_NEAR(level.log_evidence, without.log_evidence, 1e-6);
  EXPECT_LT(level.log_evidence, with_all);
}

// Two cameras see the board at every stop, more often than images are looked at: every other view is one camera's.
TEST(MlFineField, OfManyViewsEachCameraHasItsShare) {
  GeometricConfig config;
  config.stops = 150;
  config.corner_sigma_px = 0.5;  // which tells so little that all grids stay
  config.rig.cameras.resize(2);
  config.rig.T_robot_camera.resize(2);
  config.rig.min_cameras_per_stop = 2;
  Observations observations = draw_geometric_run(config).observations;
  for (RigCamera& camera : observations.cameras) camera.intrinsics_sigma = IntrinsicsSigma();
  const MlOptions options;  // of which the preparation keeps a reference
  const Preparation prepared = prepare(observations, options);
  ASSERT_EQ(prepared.repeating.fine.size(), 2U);
  for (const RemovedErrors::Fine& fine : prepared.repeating.fine) EXPECT_EQ(fine.grids.size(), 3U);
}

}  // namespace
}  // namespace rigproof::ml
