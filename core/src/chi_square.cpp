#include "rigproof/core/chi_square.h"

#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <limits>

namespace rigproof {
namespace {

// Boost throws where there is no degree of freedom; callers that count them from data take it as no answer.
constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double chi_square_quantile(double probability, double degrees_of_freedom) {
  return degrees_of_freedom > 0.0 ? 2.0 * boost::math::gamma_p_inv(0.5 * degrees_of_freedom, probability) : 0.0;
}

double chi_square_tail(double x, double degrees_of_freedom) {
  if (x <= 0.0) return 1.0;
  return degrees_of_freedom > 0.0 ? boost::math::gamma_q(0.5 * degrees_of_freedom, 0.5 * x) : kUndefined;
}

double noncentral_chi_square_tail(double x, double degrees_of_freedom, double noncentrality) {
  if (x <= 0.0 || !(degrees_of_freedom > 0.0) || noncentrality <= 0.0) return chi_square_tail(x, degrees_of_freedom);
  const boost::math::non_central_chi_squared distribution(degrees_of_freedom, noncentrality);
  return boost::math::cdf(boost::math::complement(distribution, x));
}

}  // namespace rigproof
