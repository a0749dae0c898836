#include "paired_test.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "rigproof/core/random.h"

namespace rigproof {
namespace {

constexpr std::size_t kMostExact = 50;
constexpr int kResamples = 1000;

// Twice the rank of each size, so that mean ranks are whole numbers.
std::vector<int> doubled_ranks(const std::vector<double>& sizes) {
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return sizes[a] < sizes[b]; });
  std::vector<int> ranks(sizes.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && sizes[order[end]] == sizes[order[begin]]) ++end;
    for (std::size_t i = begin; i < end; ++i) ranks[order[i]] = static_cast<int>(begin + 1 + end);
    begin = end;
  }
  return ranks;
}

// Share of the sign patterns whose sum of positive ranks is at most `sum`.
double exact_lower_tail(const std::vector<int>& ranks, int sum) {
  const int total = std::accumulate(ranks.begin(), ranks.end(), 0);
  std::vector<double> share(static_cast<std::size_t>(total) + 1, 0.0);
  share[0] = 1.0;
  int reached = 0;
  for (const int rank : ranks) {
    reached += rank;
    for (int s = reached; s >= 0; --s) {
      const double without = share[static_cast<std::size_t>(s)];
      const double with = s >= rank ? share[static_cast<std::size_t>(s - rank)] : 0.0;
      share[static_cast<std::size_t>(s)] = 0.5 * (without + with);
    }
  }
  return std::accumulate(share.begin(), share.begin() + sum + 1, 0.0);
}

double normal_lower_tail(const std::vector<int>& ranks, int sum) {
  // Sums of doubled ranks: mean half of their total, variance a quarter of their squares.
  double total = 0.0, squares = 0.0;
  for (const int rank : ranks) {
    total += rank;
    squares += static_cast<double>(rank) * rank;
  }
  const double continuity = 1.0;  // half a rank
  const double z = (sum + continuity - 0.5 * total) / std::sqrt(0.25 * squares);
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

}  // namespace

std::optional<double> signed_rank_p(const std::vector<double>& differences) {
  std::vector<double> sizes;
  std::vector<bool> positive;
  for (const double difference : differences) {
    if (difference == 0.0) continue;
    sizes.push_back(std::abs(difference));
    positive.push_back(difference > 0.0);
  }
  if (sizes.empty()) return std::nullopt;
  const std::vector<int> ranks = doubled_ranks(sizes);
  int above = 0, below = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) (positive[i] ? above : below) += ranks[i];
  const int smaller = std::min(above, below);
  const double tail = sizes.size() <= kMostExact ? exact_lower_tail(ranks, smaller) : normal_lower_tail(ranks, smaller);
  return std::min(1.0, 2.0 * tail);
}

double quantile_of(const std::vector<double>& sorted, double probability) {
  const double place = probability * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

std::optional<MeanInterval> bootstrap_mean(const std::vector<double>& values, std::uint64_t stream) {
  if (values.size() < 2) return std::nullopt;
  RandomStream random(stream, "sweep bootstrap");
  std::vector<double> means;
  for (int i = 0; i < kResamples; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k)
      sum += values[random.below(static_cast<std::uint32_t>(values.size()))];
    means.push_back(sum / static_cast<double>(values.size()));
  }
  std::sort(means.begin(), means.end());
  return MeanInterval{quantile_of(means, 0.025), quantile_of(means, 0.975)};
}

std::vector<double> holm_corrected(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> corrected(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, std::min(1.0, p[order[i]] * static_cast<double>(p.size() - i)));
    corrected[order[i]] = largest;
  }
  return corrected;
}

}  // namespace rigproof
