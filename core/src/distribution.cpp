#include "rigproof/core/distribution.h"

#include <algorithm>
#include <numeric>

namespace rigproof {
namespace {

// A normal is cut here, so that every distribution has bounds that a configuration can be checked against.
constexpr double kNormalBound = 6.0;

struct Sample {
  RandomStream& random;
  double operator()(double constant) const { return constant; }
  double operator()(const Distribution::Uniform& u) const { return random.uniform(u.low, u.high); }
  double operator()(const Distribution::Normal& n) const {
    return n.mean + n.standard_deviation * std::clamp(random.normal(), -kNormalBound, kNormalBound);
  }
  double operator()(const Distribution::Choice& c) const {
    return c.values.empty() ? 0.0 : c.values[random.below(static_cast<std::uint32_t>(c.values.size()))];
  }
};

struct Mean {
  double operator()(double constant) const { return constant; }
  double operator()(const Distribution::Uniform& u) const { return 0.5 * (u.low + u.high); }
  double operator()(const Distribution::Normal& n) const { return n.mean; }
  double operator()(const Distribution::Choice& c) const {
    if (c.values.empty()) return 0.0;
    return std::accumulate(c.values.begin(), c.values.end(), 0.0) / static_cast<double>(c.values.size());
  }
};

// Bound in the direction of `sign`: -1 the lowest, +1 the highest value.
struct Bound {
  double sign;
  double operator()(double constant) const { return constant; }
  double operator()(const Distribution::Uniform& u) const { return sign < 0.0 ? u.low : u.high; }
  double operator()(const Distribution::Normal& n) const { return n.mean + sign * kNormalBound * n.standard_deviation; }
  double operator()(const Distribution::Choice& c) const {
    if (c.values.empty()) return 0.0;
    const auto [low, high] = std::minmax_element(c.values.begin(), c.values.end());
    return sign < 0.0 ? *low : *high;
  }
};

}  // namespace

double Distribution::sample(RandomStream& random) const { return std::visit(Sample{random}, kind_); }
double Distribution::mean() const { return std::visit(Mean{}, kind_); }
double Distribution::lowest() const { return std::visit(Bound{-1.0}, kind_); }
double Distribution::highest() const { return std::visit(Bound{+1.0}, kind_); }

}  // namespace rigproof
