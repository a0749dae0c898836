// Typed random values of a configuration.
#pragma once

#include <variant>
#include <vector>

#include "rigproof/core/random.h"

namespace rigproof {

/// A number, or how to draw one. In YAML: 0.5, {uniform: [a, b]}, {normal: {mean: m, stddev: s}}, {choice: [..]}.
class Distribution {
 public:
  struct Uniform {
    double low, high;
  };
  struct Normal {
    double mean, standard_deviation;
  };
  struct Choice {
    std::vector<double> values;
  };
  using Kind = std::variant<double, Uniform, Normal, Choice>;

  Distribution(double constant = 0.0) : kind_(constant) {}  // NOLINT: a plain number is a distribution
  Distribution(Kind kind) : kind_(std::move(kind)) {}       // NOLINT

  double sample(RandomStream& random) const;
  double mean() const;
  /// Smallest and largest value that can be drawn (a normal is bounded at 6 standard deviations).
  double lowest() const;
  double highest() const;
  const Kind& kind() const { return kind_; }

 private:
  Kind kind_;
};

}  // namespace rigproof
