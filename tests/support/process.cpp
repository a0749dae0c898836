#include "process.h"

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <thread>

namespace rigproof {
namespace {

constexpr auto kReadyWithin = std::chrono::minutes(1), kEndsWithin = std::chrono::minutes(5);

bool redirect(const std::string& file, int descriptor) {
  const int opened = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  return opened >= 0 && dup2(opened, descriptor) >= 0;
}

// Returns only if it fails.
int become(const std::vector<std::string>& argv, const std::string& folder, const std::string& scratch) {
  if (!redirect(scratch + "/out", STDOUT_FILENO) || !redirect(scratch + "/err", STDERR_FILENO)) return 126;
  if (!folder.empty() && chdir(folder.c_str()) != 0) return 126;
  std::vector<char*> pointers;
  for (const std::string& word : argv) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  execvp(pointers[0], pointers.data());
  return 127;
}

// Whether it came true in time.
bool comes_true(const std::function<bool()>& condition, std::chrono::steady_clock::duration within) {
  const auto end = std::chrono::steady_clock::now() + within;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

bool handles(pid_t pid, int signal) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  const std::string key = "SigCgt:";
  for (std::string line; std::getline(status, line);)
    if (line.rfind(key, 0) == 0) return (std::stoull(line.substr(key.size()), nullptr, 16) >> (signal - 1) & 1U) != 0;
  return false;
}

}  // namespace

BackgroundProcess::BackgroundProcess(const std::vector<std::string>& argv, const std::string& folder)
    : child_([&] { return become(argv, folder, scratch_.path().string()); }) {}

std::string BackgroundProcess::said() const { return scratch_.read("out") + scratch_.read("err"); }

void BackgroundProcess::wait_until(const std::function<bool()>& ready) {
  bool ended = false;
  const bool in_time = comes_true([&] { return ready() || (ended = child_.poll().has_value()); }, kReadyWithin);
  if (ended) throw std::runtime_error("it ended before it was ready: " + said());
  if (!in_time) throw std::runtime_error("it was not ready in time: " + said());
}

void BackgroundProcess::wait_until_it_handles(int signal) {
  wait_until([&] { return handles(child_.pid(), signal); });
}

ProcessOutput BackgroundProcess::wait() {
  std::optional<ProcessEnd> end;
  if (!comes_true([&] { return (end = child_.poll()).has_value(); }, kEndsWithin))
    throw std::runtime_error("it did not end in time: " + said());
  return {end->signal != 0 ? 128 + end->signal : end->exit_code, scratch_.read("out"), scratch_.read("err")};
}

ProcessOutput run_process(const std::vector<std::string>& argv, const std::string& folder) {
  return BackgroundProcess(argv, folder).wait();
}

}  // namespace rigproof
