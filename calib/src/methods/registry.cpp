#include "rigproof/calib/memroc.h"
#include "rigproof/calib/method.h"
#include "rigproof/calib/ml.h"
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

const std::vector<const Method*>& all_methods() {
  static const std::vector<const Method*> methods = {
      &ml_method(),
      &joint_memroc_method(),
      &memroc_method(),
  };
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
