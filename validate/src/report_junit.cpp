#include <cstdint>
#include <map>

#include "rigproof/core/figures.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "rigproof/validate/format.h"
#include "rigproof/validate/report_files.h"
#include "said.h"

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

std::string coded_properties(const char* code, const char* words, const std::vector<Finding>& findings,
                             const Wording& wording) {
  std::string text;
  for (const Finding& finding : findings) {
    text += property(code, finding.code);
    if (wording) text += property(words, wording(finding));
  }
  return text;
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
  if (comparison.suspicion)
    text += coded_properties("convention_code", "convention", {comparison.suspicion->convention}, wording);
  if (const auto explanation = explain_failures(comparison, record.budget))
    text += coded_properties("cause_code", "cause", {explanation->cause}, wording);
  text += coded_properties("code", "reason", comparison.reasons, wording);
  text += coded_properties("note_code", "note", record.gate.notes, wording);
  return text + "    </properties>\n";
}

std::string testcase(const std::string& classname, const std::string& name, const std::string& content = {}) {
  const std::string start = "    <testcase" + attribute("classname", classname) + attribute("name", name);
  return start + (content.empty() ? "/>\n" : ">\n" + content + "    </testcase>\n");
}

// `element` is failure or error.
std::string outcome(const char* element, const std::string& message, const std::string& type) {
  return std::string("      <") + element + attribute("message", message) + attribute("type", type) + "/>\n";
}

std::string testcase_of(const Check& check, const std::string& classname, const Wording& wording) {
  const std::string name = check.unit == "sigma" ? check.name + " in sigmas" : check.name;
  if (check.passed) return testcase(classname, name);
  return testcase(classname, name,
                  outcome("failure", check.message(wording), check.reason ? check.reason->code : "budget"));
}

std::string nothing_checked(const ValidationRecord& record, const std::string& classname, const Wording& wording) {
  std::string message = "nothing could be checked against the budget";
  for (const Finding& note : record.gate.notes) message += "; " + said(note, wording);
  return testcase(classname, "budget", outcome("failure", message, "budget"));
}

struct Counts {
  std::size_t tests = 0, failures = 0, errors = 0;

  Counts& operator+=(const Counts& more) {
    tests += more.tests;
    failures += more.failures;
    errors += more.errors;
    return *this;
  }
  std::string attributes() const {
    return attribute("tests", std::to_string(tests)) + attribute("failures", std::to_string(failures)) +
           attribute("errors", std::to_string(errors));
  }
};

// A gate that checked nothing counts as one failure.
Counts counts_of(const ValidationRecord& record) {
  if (!record.unreadable.empty()) return {1, 0, 1};
  if (record.gate.checks.empty()) return {1, 1, 0};
  return {record.gate.checks.size(), record.gate.failures(), 0};
}

std::string testcases_of(const ValidationRecord& record, const std::string& classname, const Wording& wording) {
  if (!record.unreadable.empty())
    return testcase(classname, "result", outcome("error", record.unreadable, "unreadable"));
  if (record.gate.checks.empty()) return nothing_checked(record, classname, wording);
  std::string text;
  for (const Check& check : record.gate.checks) text += testcase_of(check, classname, wording);
  return text;
}

std::string testsuite_of(const ValidationRecord& record, const Wording& wording) {
  const std::string name = record.subject.empty() ? record.comparison.method : record.subject;
  return "  <testsuite" + attribute("name", name) + counts_of(record).attributes() + ">\n" +
         (record.unreadable.empty() ? properties_of(record, wording) : "") +
         testcases_of(record, "rigproof." + name, wording) + "  </testsuite>\n";
}

}  // namespace

std::string to_junit(const std::vector<ValidationRecord>& records, const Wording& wording) {
  Counts counts;
  std::string suites;
  for (const ValidationRecord& record : records) {
    counts += counts_of(record);
    suites += testsuite_of(record, wording);
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + attribute("name", "rigproof validate") +
         counts.attributes() + ">\n" + suites + "</testsuites>\n";
}

void save_junit(const std::vector<ValidationRecord>& records, const std::filesystem::path& file,
                const Wording& wording) {
  write_file_atomically(file, to_junit(records, wording));
}

}  // namespace rigproof
