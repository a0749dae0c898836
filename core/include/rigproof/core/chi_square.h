// The chi-square distribution.
#pragma once

namespace rigproof {

/// Quantile of chi-square: x with P(chi-square <= x) = probability, 0 < probability < 1.
double chi_square_quantile(double probability, double degrees_of_freedom);
/// P(chi-square > x), accurate far out in the tail, too.
double chi_square_tail(double x, double degrees_of_freedom);
/// P(X > x) where X is the sum of squares of unit normals whose means have `noncentrality` as sum of squares.
double noncentral_chi_square_tail(double x, double degrees_of_freedom, double noncentrality);

}  // namespace rigproof
