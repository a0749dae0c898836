// The numbers by which a lens's fine field is an unknown: few, and nothing that corners tell is left out.
#include "fine_numbers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/calib/estimate/preparation.h"
#include "rigproof/core/random.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof::ml {
namespace {

using Grid = RemovedErrors::Fine::Grid;
const std::vector<Grid> kGrids = {{8, 0.3, 0.4}, {12, 0.2, 0.5}, {16, 0.2, 0.1}};

// Covariance of what the grids displace two pixels by, along one axis.
double covariance(const Camera& camera, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  double sum = 0.0;
  for (const Grid& grid : kGrids) {
    const FineField field(camera, grid.cells);
    for (const FineField::Share& of_a : field.at(a))
      for (const FineField::Share& of_b : field.at(b))
        if (of_a.node == of_b.node) sum += grid.counted_px() * grid.counted_px() * of_a.weight * of_b.weight;
  }
  return sum;
}

class FineNumbersTest : public testing::Test {
 protected:
  FineNumbersTest() {
    GeometricConfig config;
    config.stops = 15;
    config.corner_sigma_px = 0.1;
    observations_ = draw_geometric_run(config).observations;
    for (const BoardView& view : observations_.board_views)
      for (const CornerObservation& corner : view.corners)
        if (view.camera == 0) pixels_.push_back(corner.pixel);
    numbers_ = numbers_for(observations_, 0, kGrids, 1.0);
  }
  const Camera& camera() const { return observations_.cameras[0].camera; }

  Observations observations_;
  std::vector<Eigen::Vector2d> pixels_;
  std::shared_ptr<const FineNumbers> numbers_;
};

TEST_F(FineNumbersTest, AreFewerThanCornersAndLeaveLessThanOneSquareOut) {
  ASSERT_TRUE(numbers_);
  int nodes = 0;
  for (const Grid& grid : kGrids) nodes += FineField(camera(), grid.cells).nodes();
  EXPECT_LT(numbers_->along_x(), nodes / 3);
  EXPECT_LT(numbers_->along_x(), static_cast<int>(pixels_.size()));
  double left_out = 0.0;
  for (const Eigen::Vector2d& pixel : pixels_) {
    const double left = covariance(camera(), pixel, pixel) - numbers_->at(pixel).squaredNorm();
    EXPECT_GT(left, -1e-9);
    left_out += left / (0.1 * 0.1);
  }
  EXPECT_LT(left_out, 1.5);  // corners that lie close together were one
  EXPECT_GT(left_out, 0.0);
}

TEST_F(FineNumbersTest, CornersAreDisplacedTogetherAsTheGridsDo) {
  for (std::size_t i = 0; i + 7 < pixels_.size(); i += 7)
    for (std::size_t j = i; j < pixels_.size(); j += 11)
      EXPECT_NEAR(numbers_->at(pixels_[i]).dot(numbers_->at(pixels_[j])), covariance(camera(), pixels_[i], pixels_[j]),
                  1e-3);
}

TEST_F(FineNumbersTest, SharperCornersTellMoreApart) {
  const auto sharper = numbers_for(observations_, 0, kGrids, 0.01);
  ASSERT_TRUE(sharper);
  EXPECT_GT(sharper->along_x(), numbers_->along_x());
}

TEST_F(FineNumbersTest, WithoutAGridThereAreNone) { EXPECT_EQ(numbers_for(observations_, 0, {}, 1.0), nullptr); }

TEST_F(FineNumbersTest, SquaresAreTheSameByCornersAndByNodes) {
  FineSquares few(*numbers_, 1), many(*numbers_, 1000000);
  RandomStream random(1, "fine numbers");
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(numbers_->size(), numbers_->size());
  for (const Eigen::Vector2d& pixel : pixels_) {
    Eigen::Matrix2d root;
    root << random.normal(), random.normal(), random.normal(), random.normal();
    const Eigen::VectorXd by_number = numbers_->at(pixel);
    few.add(pixel, by_number, root.transpose() * root);
    many.add(pixel, by_number, root.transpose() * root);
    const Eigen::Matrix2Xd rows = FineNumbers::rows(root, by_number);
    whole += rows.transpose() * rows;
  }
  EXPECT_TRUE(few.sum().isApprox(whole, 1e-9));
  EXPECT_TRUE(many.sum().isApprox(whole, 1e-9));
}

TEST_F(FineNumbersTest, OnOtherGridsTheSameIsTakenOut) {
  for (RigCamera& camera : observations_.cameras) camera.intrinsics_sigma = IntrinsicsSigma();
  const MlOptions options;  // of which the preparation keeps a reference
  RemovedErrors removed = prepare(observations_, options).repeating;
  describe_by(kGrids, 0, observations_, &removed);
  RandomStream random(2, "fine numbers");
  for (double& number : removed.fine[0].value) number = random.normal();
  const RemovedErrors::Fine before = removed.fine[0];
  describe_by({{16, 0.5, 1.0}}, 0, observations_, &removed);
  const RemovedErrors::Fine& now = removed.fine[0];
  ASSERT_EQ(now.grids.size(), 1U);
  double difference = 0.0, size = 0.0;
  for (const Eigen::Vector2d& pixel : pixels_) {
    const Eigen::Vector2d displaced = before.numbers->displacement(pixel, before.value);
    difference += (now.numbers->displacement(pixel, now.value) - displaced).squaredNorm();
    size += displaced.squaredNorm();
  }
  EXPECT_LT(std::sqrt(difference / size), 0.1);
}

TEST_F(FineNumbersTest, WhatIsTakenOutCostsItsSquares) {
  RemovedErrors removed = none_removed(observations_, usual_priors());
  EXPECT_EQ(removed.cost(), 0.0);
  removed.value = Eigen::Vector2d(1.0, 2.0);
  removed.fine.resize(1);
  removed.fine[0].value = Eigen::Vector2d(3.0, 4.0);
  EXPECT_DOUBLE_EQ(removed.cost(), 30.0);
}

}  // namespace
}  // namespace rigproof::ml
