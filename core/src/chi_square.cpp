#include "rigproof/core/chi_square.h"

#include <cmath>
#include <limits>

namespace rigproof {
namespace {

constexpr double kTolerance = 1e-15;
constexpr int kMaxTerms = 10000;

// x^shape e^-x / Gamma(shape).
double gamma_density_factor(double shape, double x) { return std::exp(shape * std::log(x) - x - std::lgamma(shape)); }

// Series of P, converges fast for x < shape + 1 (Abramowitz and Stegun 6.5.29).
double gamma_series(double shape, double x) {
  double term = 1.0 / shape, sum = term;
  for (int n = 1; n < kMaxTerms && term > sum * kTolerance; ++n) {
    term *= x / (shape + n);
    sum += term;
  }
  return sum * gamma_density_factor(shape, x);
}

// Continued fraction of Q = 1 - P by Lentz's method, for x >= shape + 1 (Abramowitz and Stegun 6.5.31).
double gamma_fraction(double shape, double x) {
  constexpr double kTiny = std::numeric_limits<double>::min() * 1e10;
  double b = x + 1.0 - shape, c = 1.0 / kTiny, d = 1.0 / b, h = d;
  for (int i = 1; i < kMaxTerms; ++i) {
    const double a = -i * (i - shape);
    b += 2.0;
    d = a * d + b;
    c = b + a / c;
    if (std::abs(d) < kTiny) d = kTiny;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1.0 / d;
    h *= d * c;
    if (std::abs(d * c - 1.0) < kTolerance) break;
  }
  return h * gamma_density_factor(shape, x);
}

}  // namespace

double regularised_gamma(double shape, double x) {
  if (x <= 0.0) return 0.0;
  return x < shape + 1.0 ? gamma_series(shape, x) : 1.0 - gamma_fraction(shape, x);
}

double chi_square_quantile(double probability, double degrees_of_freedom) {
  const double shape = 0.5 * degrees_of_freedom;
  double low = 0.0, high = degrees_of_freedom + 10.0;
  while (regularised_gamma(shape, 0.5 * high) < probability) high *= 2.0;
  // Bisection: monotone and without a guess that could fail; 200 halvings reach the last bit.
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (regularised_gamma(shape, 0.5 * middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double chi_square_tail(double x, double degrees_of_freedom) {
  const double shape = 0.5 * degrees_of_freedom, half = 0.5 * x;
  if (half <= 0.0) return 1.0;
  return half < shape + 1.0 ? 1.0 - gamma_series(shape, half) : gamma_fraction(shape, half);
}

double noncentral_chi_square_tail(double x, double degrees_of_freedom, double noncentrality) {
  // A mixture of central ones with two degrees more each, in Poisson's proportions; from its middle outwards.
  const double mean = 0.5 * noncentrality;
  const auto term = [&](int k) {
    const double log_share = mean > 0.0 ? k * std::log(mean) - mean - std::lgamma(k + 1.0) : 0.0;
    return std::exp(log_share) * chi_square_tail(x, degrees_of_freedom + 2.0 * k);
  };
  if (mean <= 0.0) return term(0);
  const int middle = static_cast<int>(mean);
  double sum = 0.0;
  for (int k = middle; k >= 0; --k) {
    const double part = term(k);
    sum += part;
    if (part < kTolerance * sum) break;
  }
  for (int k = middle + 1; k < middle + kMaxTerms; ++k) {
    const double part = term(k);
    sum += part;
    if (part < kTolerance) break;
  }
  return sum;
}

}  // namespace rigproof
