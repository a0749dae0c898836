// What the command prints: lines, colours and one line of progress. Colours and progress only on a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace rigproof {

enum class Color { kNone, kGood, kBad, kWarning, kDim };

/// Standard output, as a person or a pipe reads it.
class Terminal {
 public:
  explicit Terminal(bool quiet);

  /// Prints the text and a line feed, unless quiet.
  void line(const std::string& text = "") const;
  /// Prints text that brings its own line feeds, unless quiet.
  void text(const std::string& text) const;
  /// The text in a colour, where the output is a terminal.
  std::string colored(const std::string& text, Color color) const;
  bool quiet() const { return quiet_; }

 private:
  bool quiet_;
  bool use_color_;
};

/// One line that counts: "generate  120/300 images  21/s  14 s". Rewritten in place on a terminal (standard error),
/// where lines of Terminal take its place; silent elsewhere. Hand it to a long task as its progress callback.
class ProgressLine {
 public:
  ProgressLine(const Terminal& terminal, std::string label, std::string noun);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Shows the count. Returns false once the user has interrupted the program.
  bool update(std::size_t done, std::size_t total);
  std::function<bool(std::size_t, std::size_t)> callback();
  double seconds() const;
  /// Off the terminal until it counts on.
  void erase();

 private:
  const Terminal& terminal_;
  std::string label_;
  std::string noun_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point shown_;
  bool visible_ = false;
};

/// Lets SIGINT and SIGTERM ask long tasks to stop at the next safe point; a second one ends the program at once. A file
/// that grows too large is an error of whoever writes it, no signal.
void install_interrupt_handler();
bool interrupted();

/// "14 s", "2.1 s", "3 min 20 s".
std::string duration(double seconds);

}  // namespace rigproof
