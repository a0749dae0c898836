#include "rigproof/calib/methods/registry.h"

#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

// The methods in the order in which users see them: a line a file, which defines NAME_methods().
#define RIGPROOF_METHOD_FILES(FILE) \
  FILE(ml)                          \
  FILE(memroc)                      \
  FILE(memroc_reference)            \
  FILE(robot_autocalib)             \
  FILE(robot_autocalib_board)       \
  FILE(sensorx2car)                 \
  FILE(li)                          \
  FILE(opencv_hand_eye)

namespace rigproof {

#define RIGPROOF_DECLARE(name) std::vector<const Method*> name##_methods();
RIGPROOF_METHOD_FILES(RIGPROOF_DECLARE)
#undef RIGPROOF_DECLARE

const std::vector<const Method*>& all_methods() {
  static const std::vector<const Method*> methods = [] {
    std::vector<const Method*> all;
#define RIGPROOF_APPEND(name) \
  for (const Method* method : name##_methods()) all.push_back(method);
    RIGPROOF_METHOD_FILES(RIGPROOF_APPEND)
#undef RIGPROOF_APPEND
    return all;
  }();
  return methods;
}

const Method& find_method(const std::string& name) {
  std::vector<std::string> known;
  for (const Method* method : all_methods()) {
    known.push_back(method->traits().name);
    if (known.back() == name) return *method;
  }
  for (const Method* method : memroc_chain_methods())
    if (method->traits().name == name) return *method;
  throw Error("method: \"" + for_message(name) + "\": there is no such method; " + suggestion(name, known));
}

const Method& default_method() { return ml_method(); }

std::vector<const Method*> ml_methods() { return {&ml_method()}; }

}  // namespace rigproof
