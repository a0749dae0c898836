// Statistical tests: how many trials they take, and how far their means may lie off by chance.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

namespace rigproof {

/// A few trials by default, all of them where RIGPROOF_TRIALS=full, as in `scripts/test --full`, and hardly any where
/// it is `least`, as under the sanitizers, which look at what is computed and not at the result. Cases that count on it
/// end in OverTrials and have ctest's label `statistical`.
class Trials {
 public:
  Trials(int few, int all) : all_(all), count_(asked("full") ? all : asked("least") ? (few + 7) / 8 : few) {}

  int count() const { return count_; }
  /// What is right for a mean of all trials, for the mean of as many as there are: it scatters sqrt(all / count) times
  /// as far.
  double tolerance(double of_all) const { return of_all * std::sqrt(static_cast<double>(all_) / count_); }
  /// Three standard deviations of the mean of as many chi-squares with these degrees of freedom, NEES say.
  double chi_square_tolerance(int degrees_of_freedom) const {
    return 3.0 * std::sqrt(2.0 * degrees_of_freedom / count_);
  }

 private:
  static bool asked(const char* how_many) {
    const char* asked = std::getenv("RIGPROOF_TRIALS");
    return asked != nullptr && std::string(asked) == how_many;
  }

  int all_, count_;
};

}  // namespace rigproof
