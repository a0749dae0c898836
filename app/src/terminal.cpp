#include "terminal.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "rigproof/core/text.h"

namespace rigproof {
namespace {

std::atomic<int> interrupt_count{0};

// The one line of progress that stands on the terminal; what is printed takes its place.
ProgressLine* shown_line = nullptr;

void on_interrupt(int signal_number) {
  if (++interrupt_count > 1) {
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
  }
}

const char* escape_of(Color color) {
  switch (color) {
    case Color::kGood:
      return "\033[32m";
    case Color::kBad:
      return "\033[31m";
    case Color::kWarning:
      return "\033[33m";
    case Color::kDim:
      return "\033[2m";
    case Color::kNone:
      break;
  }
  return "";
}

}  // namespace

Terminal::Terminal(bool quiet)
    : quiet_(quiet), use_color_(isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr) {}

void Terminal::line(const std::string& text) const { this->text(text + "\n"); }

void Terminal::text(const std::string& text) const {
  if (quiet_) return;
  if (shown_line != nullptr) shown_line->erase();
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

std::string Terminal::colored(const std::string& text, Color color) const {
  if (!use_color_ || color == Color::kNone) return text;
  return escape_of(color) + text + "\033[0m";
}

ProgressLine::ProgressLine(const Terminal& terminal, std::string label, std::string noun)
    : terminal_(terminal), label_(std::move(label)), noun_(std::move(noun)), start_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() { erase(); }

void ProgressLine::erase() {
  if (!visible_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  visible_ = false;
  shown_line = nullptr;
}

bool ProgressLine::update(std::size_t done, std::size_t total) {
  const auto now = std::chrono::steady_clock::now();
  const bool due = !visible_ || now - shown_ > std::chrono::milliseconds(100);
  if (due && !terminal_.quiet() && isatty(STDERR_FILENO) != 0) {
    const double elapsed = seconds();
    std::string text = label_ + "  " + std::to_string(done) + "/" + std::to_string(total) + " " + noun_;
    if (done > 0 && elapsed > 0.5) {
      const double rate = static_cast<double>(done) / elapsed;
      text += "  " + fixed_text(rate, rate < 10.0 ? 1 : 0) + "/s  " +
              duration(static_cast<double>(total - done) / rate) + " left";
    }
    std::fputs(("\r\033[K" + text).c_str(), stderr);
    std::fflush(stderr);
    visible_ = true;
    shown_line = this;
    shown_ = now;
  }
  return !interrupted();
}

std::function<bool(std::size_t, std::size_t)> ProgressLine::callback() {
  return [this](std::size_t done, std::size_t total) { return update(done, total); };
}

double ProgressLine::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void install_interrupt_handler() {
  struct sigaction action = {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond `ulimit -f` then fails, and the error names the file
}

bool interrupted() { return interrupt_count > 0; }

std::string duration(double seconds) {
  if (seconds < 10.0) return fixed_text(seconds, 1) + " s";
  if (seconds < 120.0) return fixed_text(seconds, 0) + " s";
  const int whole = static_cast<int>(seconds);
  return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
}

}  // namespace rigproof
