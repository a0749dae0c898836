#include "jobs.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr std::chrono::seconds kGrace{2};

void write_line(int descriptor, std::string line) {
  line += '\n';
  for (std::size_t at = 0; at < line.size();) {
    const ssize_t written = write(descriptor, line.data() + at, line.size() - at);
    if (written < 0 && errno != EINTR) return;  // the owner is gone
    if (written > 0) at += static_cast<std::size_t>(written);
  }
}

}  // namespace

void ForkedJobs::start(std::size_t job, const Work& work) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw Error(std::string("pipe: ") + std::strerror(errno), ExitCode::kTryAgain);
  ChildProcess process([&] {
    close(ends[0]);
    for (const auto& [other, child] : children_) close(child.pipe);
    std::signal(SIGPIPE, SIG_IGN);
    work([&ends](const std::string& line) { write_line(ends[1], line); });
    return 0;
  });
  close(ends[1]);
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  children_.emplace(job, Child{std::move(process), ends[0], {}});
}

void ForkedJobs::read_from(std::size_t job, Child* child, std::vector<News>* news) {
  std::array<char, 65536> buffer{};
  for (;;) {
    const ssize_t got = read(child->pipe, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return;  // no more for now
    if (got == 0) break;
    child->unread.append(buffer.data(), static_cast<std::size_t>(got));
    for (std::size_t end = child->unread.find('\n'); end != std::string::npos; end = child->unread.find('\n')) {
      news->push_back({job, false, child->unread.substr(0, end), {}});
      child->unread.erase(0, end + 1);
    }
  }
  close(child->pipe);
  news->push_back({job, true, {}, child->process.wait()});
}

std::vector<ForkedJobs::News> ForkedJobs::wait(int timeout_ms) {
  std::vector<pollfd> polls;
  std::vector<std::size_t> jobs;
  for (const auto& [job, child] : children_) {
    polls.push_back({child.pipe, POLLIN, 0});
    jobs.push_back(job);
  }
  std::vector<News> news;
  if (poll(polls.data(), polls.size(), timeout_ms) <= 0) return news;
  for (std::size_t i = 0; i < polls.size(); ++i)
    if (polls[i].revents != 0) read_from(jobs[i], &children_.at(jobs[i]), &news);
  for (const News& item : news)
    if (item.ended) children_.erase(item.job);
  return news;
}

void ForkedJobs::stop() {
  for (const auto& [job, child] : children_) child.process.send(SIGTERM);
  const auto end = std::chrono::steady_clock::now() + kGrace;
  for (auto& [job, child] : children_) {
    while (!child.process.poll() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    child.process.kill_all();  // what it started and left, too
    close(child.pipe);
  }
  children_.clear();
}

}  // namespace rigproof
