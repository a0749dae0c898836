// Statistical tests: how many trials they take, and how far their means may lie off by chance.
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

namespace rigproof {

/// A few trials by default, all of them where RIGPROOF_TRIALS=full, as in `scripts/test --full`. Cases that count on it
/// end in OverTrials and have ctest's label `statistical`.
class Trials {
 public:
  Trials(int few, int all) : all_(all), count_(all_are_asked() ? all : few) {}

  int count() const { return count_; }
  /// What is right for a mean of all trials, for the mean of as many as there are: it scatters sqrt(all / count) times
  /// as far.
  double tolerance(double of_all) const { return of_all * std::sqrt(static_cast<double>(all_) / count_); }

 private:
  static bool all_are_asked() {
    const char* asked = std::getenv("RIGPROOF_TRIALS");
    return asked != nullptr && std::string(asked) == "full";
  }

  int all_, count_;
};

}  // namespace rigproof
