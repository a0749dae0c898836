#include <algorithm>
#include <cstdint>
#include <map>

#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "rigproof/validate/figures.h"
#include "rigproof/validate/format.h"
#include "rigproof/validate/report_files.h"

namespace rigproof {
namespace {

// Length of the UTF-8 sequence at `text[i]` that XML 1.0 allows; 0 if there is none.
std::size_t valid_sequence(const std::string& text, std::size_t i) {
  const char first = text[i];
  const bool control = static_cast<std::uint8_t>(first) < 0x20 && first != '\t' && first != '\n' && first != '\r';
  const bool noncharacter = text.compare(i, 3, "\xEF\xBF\xBE") == 0 || text.compare(i, 3, "\xEF\xBF\xBF") == 0;
  return control || noncharacter ? 0 : utf8_length(text, i);
}

std::string escaped(const std::string& text) {
  // A plain line feed in an attribute would be read as a space.
  static const std::map<char, const char*> entities = {{'&', "&amp;"},  {'<', "&lt;"},  {'>', "&gt;"},  {'"', "&quot;"},
                                                       {'\n', "&#10;"}, {'\t', "&#9;"}, {'\r', "&#13;"}};
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = valid_sequence(text, i);
    if (length == 0) {
      result += '?';
      ++i;
      continue;
    }
    const auto entity = entities.find(text[i]);
    if (entity == entities.end())
      result.append(text, i, length);
    else
      result += entity->second;
    i += length;
  }
  return result;
}

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + escaped(value) + "\"";
}

std::string property(const char* name, const std::string& value) {
  return value.empty() ? ""
                       : std::string("      <property") + attribute("name", name) + attribute("value", value) + "/>\n";
}

std::string properties_of(const ValidationRecord& record, const Wording& wording) {
  const Comparison& comparison = record.comparison;
  std::string text = "    <properties>\n";
  text += property("tool", std::string("rigproof ") + version());
  text += property("method", comparison.method);
  text += property("status", result_status_name(comparison.status));
  text += property("budget", record.budget.name);
  text += property("limits", describe(record.budget));
  text += property("uncertainty", format_nees(comparison));
  if (comparison.suspicion) text += property("convention", comparison.suspicion->explanation);
  if (const auto cause = explain_failures(comparison, record.budget)) text += property("cause", cause->sentence);
  for (const Finding& reason : comparison.reasons) {
    text += property("code", reason.code);
    if (wording) text += property("reason", wording(reason));
  }
  return text + "    </properties>\n";
}

std::string failing_case(const std::string& start, const std::string& message) {
  return start + ">\n      <failure" + attribute("message", message) + attribute("type", "budget") +
         "/>\n    </testcase>\n";
}

std::string testcase_of(const Check& check, const std::string& classname, const Wording& wording) {
  const std::string name = check.unit == "sigma" ? check.name + " in sigmas" : check.name;
  const std::string start = "    <testcase" + attribute("classname", classname) + attribute("name", name);
  return check.passed ? start + "/>\n" : failing_case(start, check.message(wording));
}

std::string nothing_checked(const ValidationRecord& record, const std::string& classname, const Wording& wording) {
  std::string message = "nothing could be checked against the budget";
  for (const Finding& note : record.gate.notes) message += "; " + (wording ? wording(note) : note.code);
  return failing_case("    <testcase" + attribute("classname", classname) + attribute("name", "budget"), message);
}

// Tests and failures of a record: a gate that checked nothing counts as one failure.
std::size_t tests_of(const ValidationRecord& record) { return std::max<std::size_t>(1, record.gate.checks.size()); }
std::size_t failures_of(const ValidationRecord& record) {
  return record.gate.checks.empty() ? 1 : record.gate.failures();
}

std::string testsuite_of(const ValidationRecord& record, const Wording& wording) {
  const std::string name = record.subject.empty() ? record.comparison.method : record.subject;
  const std::string classname = "rigproof." + name;
  std::string text = "  <testsuite" + attribute("name", name) + attribute("tests", std::to_string(tests_of(record))) +
                     attribute("failures", std::to_string(failures_of(record))) + attribute("errors", "0") + ">\n" +
                     properties_of(record, wording);
  for (const Check& check : record.gate.checks) text += testcase_of(check, classname, wording);
  if (record.gate.checks.empty()) text += nothing_checked(record, classname, wording);
  return text + "  </testsuite>\n";
}

}  // namespace

std::string to_junit(const std::vector<ValidationRecord>& records, const Wording& wording) {
  std::size_t tests = 0, failures = 0;
  std::string suites;
  for (const ValidationRecord& record : records) {
    tests += tests_of(record);
    failures += failures_of(record);
    suites += testsuite_of(record, wording);
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + attribute("name", "rigproof validate") +
         attribute("tests", std::to_string(tests)) + attribute("failures", std::to_string(failures)) + ">\n" + suites +
         "</testsuites>\n";
}

void save_junit(const std::vector<ValidationRecord>& records, const std::filesystem::path& file,
                const Wording& wording) {
  write_file_atomically(file, to_junit(records, wording));
}

}  // namespace rigproof
