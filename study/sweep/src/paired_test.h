// Two methods on the same tasks: is one better?
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace rigproof {

/// Two-sided p of Wilcoxon's signed-rank test that the differences are symmetric about zero. Zeros are left out, equal
/// sizes share their mean rank. Exact up to 50 differences, else by the normal approximation with corrections for ties
/// and continuity. Absent where no difference is left.
std::optional<double> signed_rank_p(const std::vector<double>& differences);

struct MeanInterval {
  double low = 0.0;
  double high = 0.0;
};
/// 95 % interval of the mean by a bootstrap over the values (percentiles of 1000 resamples). Absent for less than two.
/// @param stream makes different samples independent; the same stream gives the same interval.
std::optional<MeanInterval> bootstrap_mean(const std::vector<double>& values, std::uint64_t stream);

/// Holm's step-down correction: each p as it counts among all of them, in the same order.
std::vector<double> holm_corrected(const std::vector<double>& p);

/// Quantile by linear interpolation between order statistics of sorted values; there must be one.
double quantile_of(const std::vector<double>& sorted, double probability);

}  // namespace rigproof
