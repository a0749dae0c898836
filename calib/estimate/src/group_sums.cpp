#include "rigproof/calib/estimate/group_sums.h"

namespace rigproof::ml {

GroupSum& GroupSum::operator+=(const GroupSum& other) {
  square += other.square;
  weighted_square += other.weighted_square;
  weight += other.weight;
  leverage += other.leverage;
  dimensions += other.dimensions;
  outlier_weighted_square += other.outlier_weighted_square;
  outlier_dimensions += other.outlier_dimensions;
  return *this;
}

void GroupSum::add(double whitened_square, double residual_weight, double residual_dimensions) {
  // Noise alone gives 45 whitened squares in three dimensions once in a billion.
  constexpr double kLeastWeightOfNoise = 1.0 / 6.0;
  const double weighted = residual_weight * whitened_square;
  square += whitened_square;
  weighted_square += weighted;
  weight += residual_weight * residual_dimensions;
  dimensions += residual_dimensions;
  if (residual_weight >= kLeastWeightOfNoise) return;
  outlier_weighted_square += weighted;
  outlier_dimensions += residual_dimensions;
}

GroupSum GroupSum::without_outliers() const {
  constexpr double kFew = 5.0;  // one in five; more say that the level is wrong
  GroupSum sum = *this;
  if (kFew * outlier_dimensions > dimensions) return sum;
  sum.weighted_square -= outlier_weighted_square;
  sum.dimensions -= outlier_dimensions;
  return sum;
}

}  // namespace rigproof::ml
