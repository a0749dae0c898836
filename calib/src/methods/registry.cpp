#include <chrono>

#include "rigproof/calib/memroc.h"
#include "rigproof/calib/method.h"
#include "rigproof/calib/ml.h"
#include "rigproof/calib/rivals.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

const Method* find_or_null(const std::string& name) {
  for (const Method* method : all_methods())
    if (method->traits().name == name) return method;
  return nullptr;
}

}  // namespace

std::string Method::why_not(const MethodInput& /*input*/) const { return {}; }

Result Method::solve_recording(const MethodInput& input) const { return solve(input.observations); }

void throw_if_interrupted(const MethodInput& input) {
  if (input.keep_going && !input.keep_going()) throw Error("interrupted", ExitCode::kTryAgain);
}

Result run_method(const Method& method, const MethodInput& input) {
  Result result;
  const std::string reason = method.why_not(input);
  const auto start = std::chrono::steady_clock::now();
  if (reason.empty())
    result = method.solve_recording(input);
  else
    result.reasons.push_back(reason);
  result.method = method.traits().name;
  result.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

const std::vector<const Method*>& all_methods() {
  static const std::vector<const Method*> methods = [] {
    std::vector<const Method*> list = {&ml_method(), &joint_memroc_method(), &memroc_method()};
    for (const Method* rival : rival_methods()) list.push_back(rival);
    return list;
  }();
  return methods;
}

const Method& find_method(const std::string& name) {
  if (const Method* method = find_or_null(name)) return *method;
  std::vector<std::string> known;
  for (const Method* method : all_methods()) known.push_back(method->traits().name);
  throw Error("method: \"" + for_message(name) + "\": there is no such method; " + suggestion(name, known));
}

const Method& default_method() { return ml_method(); }

}  // namespace rigproof
