// What is found in data or in a solution, as data: exclusions, refusals, contradictions, causes and notes. Sentences
// are made of it last, by rigproof::words, for people; no code reads one.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "rigproof/core/error.h"

namespace rigproof {

enum class Severity {
  kNote,           ///< worth knowing
  kSuspect,        ///< the answer stands, with its uncertainty, but what was stated beforehand is hardly right
  kLeftOut,        ///< a frame, or its depth, that is not used
  kRefusal,        ///< something is not answered
  kContradiction,  ///< data that contradict each other: what they concern is not answered
  kCause,          ///< the likely cause of a contradiction
};
const char* severity_name(Severity severity);

/// A named figure, whose unit is in the name ("off_mm", "board_deg"), or text ("unit": "feet").
struct FindingValue {
  FindingValue() = default;
  template <typename Number, typename = std::enable_if_t<std::is_arithmetic_v<Number>>>
  FindingValue(std::string n, Number number) : name(std::move(n)), value(static_cast<double>(number)) {}
  FindingValue(std::string n, std::string text) : name(std::move(n)), value(std::move(text)) {}
  FindingValue(std::string n, const char* text) : name(std::move(n)), value(std::string(text)) {}
  bool operator==(const FindingValue& other) const { return name == other.name && value == other.value; }

  std::string name;
  std::variant<double, std::string> value;
};
using FindingValues = std::vector<FindingValue>;

struct Finding {
  Finding() = default;
  /// One of the table (core/src/findings.def), with its severity there; any other code throws std::logic_error.
  explicit Finding(std::string known_code, FindingValues with = {});
  /// The same about a camera (or cameras), degrees of freedom, stops.
  Finding of(std::string camera) const;
  Finding of(std::vector<std::string> names) const;
  Finding along(std::vector<std::string> degrees) const;
  Finding at(std::vector<int> indices) const;
  Finding with(const FindingValues& more) const;
  Finding by(std::vector<Finding> causes) const;

  bool is(const char* other) const { return code == other; }
  const FindingValue* find(const std::string& name) const;
  bool operator==(const Finding& other) const;

  std::string code;  ///< stable: docs/reference/findings.md lists all
  Severity severity = Severity::kNote;
  std::vector<std::string> cameras;
  std::vector<std::string> axes;  ///< x y z roll pitch yaw, or tilt_x tilt_y: about the robot's axes
  std::vector<int> stops;
  FindingValues values;
  std::vector<Finding> because;  ///< what it rests on: frames by why they are left out, with `count`; what contradicts
};

/// A sentence of somebody else (another program's result, a file of before): code `stated`, its text as a value.
Finding stated(const std::string& text, Severity severity);

/// What puts findings in words; empty where nobody reads.
using Wording = std::function<std::string(const Finding&)>;

/// A JSON list, as on disk; the sentence of each where somebody words it.
std::string findings_json(const std::vector<Finding>& findings, const Wording& wording = {});
/// Reads that list. Throws Error.
std::vector<Finding> findings_of_json(const std::string& json);

bool has_code(const std::vector<Finding>& findings, const char* code);
/// Adds it unless the same is there.
void add_once(Finding finding, std::vector<Finding>* findings);
/// Likely causes first, in the table's order of precedence; what belongs to one cause stays with it, and all else keeps
/// its order.
void causes_first(std::vector<Finding>* findings);

/// An error that is a finding. what() holds its code; whoever speaks to people words it.
class FindingError : public Error {
 public:
  /// @param place what the message begins with: "suggest", a folder
  FindingError(const std::string& place, Finding finding)
      : Error(place + ": " + finding.code), place_(place), finding_(std::move(finding)) {}
  const std::string& place() const { return place_; }
  const Finding& finding() const { return finding_; }

 private:
  std::string place_;
  Finding finding_;
};

}  // namespace rigproof
