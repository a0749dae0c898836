#include "rigproof/calib/diagnose/method.h"

#include <chrono>

namespace rigproof {

std::optional<Finding> Method::why_not(const MethodInput& /*input*/) const { return std::nullopt; }

Result Method::solve_recording(const MethodInput& input) const { return solve(input.observations); }

Result run_method(const Method& method, const MethodInput& input) {
  Result result;
  const std::optional<Finding> reason = method.why_not(input);
  const auto start = std::chrono::steady_clock::now();
  if (reason)
    result.reasons = {*reason};
  else
    result = method.solve_recording(input);
  result.method = method.traits().name;
  result.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace rigproof
