// One exception type for bad input and IO, and a list that gathers all problems before it throws.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace rigproof {

/// What the process returns to its caller; part of the command's contract.
enum class ExitCode : int {
  kGood = 0,
  kGateFailed = 1,
  kBadInput = 2,
  kRefused = 3,    ///< the data cannot answer
  kTryAgain = 75,  ///< EX_TEMPFAIL: a retry may succeed
};

/// Bad input or environment. The message is complete: it names file, line, field, value and what is allowed.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, ExitCode exit_code = ExitCode::kBadInput)
      : std::runtime_error(message), exit_code_(exit_code) {}
  ExitCode exit_code() const { return exit_code_; }

 private:
  ExitCode exit_code_;
};

/// One thing that is wrong with an input. Empty parts are left out of the message; line 0 means "no line".
struct Problem {
  std::string file;
  int line = 0;
  std::string field;    ///< dotted path, e.g. "cameras.left.fx_px"
  std::string value;    ///< as written
  std::string message;  ///< what is wrong and what is allowed

  /// "file:line: field: value: message".
  std::string text() const;
};

/// Gathers every problem of an input so that the user sees all of them at once.
class Problems {
 public:
  void add(Problem problem) { problems_.push_back(std::move(problem)); }
  void append(const Problems& other);
  /// Orders them by file and line, as a person goes through them.
  void sort();
  bool empty() const { return problems_.empty(); }
  const std::vector<Problem>& all() const { return problems_; }
  /// One line a problem; of very many only the first 40.
  std::string text() const;
  /// Throws Error with all problems if there is any.
  void throw_if_any() const;

 private:
  std::vector<Problem> problems_;
};

}  // namespace rigproof
