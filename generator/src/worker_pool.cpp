#include "worker_pool.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>
#include <thread>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

// One job in work and one waiting, so that a process never waits for its next one.
constexpr std::size_t kQueueLength = 2;
// Longest message: a result lists a few files; an error message is cut off.
constexpr std::size_t kMaxMessage = 32768;
// How long the last job of each process is waited for, and how often it is asked.
constexpr double kMaxGraceS = 10.0;
constexpr auto kPollPeriod = std::chrono::milliseconds(2);

// First byte of a message from a process. The second of a failure is its exit code.
constexpr char kTagReady = 'R', kTagDone = 'D', kTagFailed = 'F';

std::string cause(int error_number) { return std::generic_category().message(error_number); }

void send_message(int socket, const std::string& message) {
  const std::size_t size = std::min(message.size(), kMaxMessage);
  // The owner is gone: so is the reason to go on.
  if (::send(socket, message.data(), size, MSG_NOSIGNAL) < 0) ::_exit(1);
}

void send_failure(int socket, const std::string& what, ExitCode exit_code) {
  send_message(socket, std::string{kTagFailed, static_cast<char>(exit_code)} + what);
}

[[noreturn]] void serve(int socket, const WorkerPool::Prepare& prepare) {
  try {
    std::string greeting;
    const WorkerPool::Handler handler = prepare(&greeting);
    send_message(socket, kTagReady + greeting);
    std::uint32_t job = 0;
    while (::recv(socket, &job, sizeof job, 0) == static_cast<ssize_t>(sizeof job)) {
      send_message(socket, kTagDone + handler(job));
    }
    ::_exit(0);
  } catch (const Error& error) {
    send_failure(socket, error.what(), error.exit_code());
  } catch (const std::exception& error) {
    send_failure(socket, error.what(), ExitCode::kBadInput);
  } catch (...) {
    send_failure(socket, "unknown exception", ExitCode::kBadInput);
  }
  ::_exit(1);
}

std::string how_it_ended(const ProcessEnd& end) {
  return end.in_words() + (end.signal == SIGKILL ? "; the machine may be out of memory" : "");
}

}  // namespace

WorkerPool::WorkerPool(int processes, const Prepare& prepare, double patience_s) : patience_s_(patience_s) {
  workers_.reserve(static_cast<std::size_t>(processes));
  for (int i = 0; i < processes; ++i) start(prepare);
}

void WorkerPool::start(const Prepare& prepare) {
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
    throw Error("cannot start a render process: " + cause(errno), ExitCode::kTryAgain);
  }
  ChildProcess process([&]() -> int {
    ::close(sockets[0]);
    for (const Worker& other : workers_) ::close(other.socket);
    serve(sockets[1], prepare);
  });
  ::close(sockets[1]);
  workers_.push_back({std::move(process), sockets[0], {}, std::chrono::steady_clock::now()});
}

// At the end of its input a process ends: at once where it is idle, else after the job in work, which may be half a
// file. One that takes too long is killed by its ChildProcess.
WorkerPool::~WorkerPool() {
  for (const Worker& worker : workers_)
    if (worker.socket >= 0) ::close(worker.socket);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(std::min(patience_s_, kMaxGraceS));
  for (Worker& worker : workers_) {
    while (worker.process.is_running() && !worker.process.poll() && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(kPollPeriod);
  }
}

std::size_t WorkerPool::least_busy() const {
  std::size_t best = workers_.size();
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    if (workers_[i].socket < 0) continue;
    if (best == workers_.size() || workers_[i].queue.size() < workers_[best].queue.size()) best = i;
  }
  return best;
}

bool WorkerPool::wants_job() const {
  const std::size_t i = least_busy();
  return i < workers_.size() && workers_[i].queue.size() < kQueueLength;
}

void WorkerPool::submit(std::uint32_t job) {
  const std::size_t i = least_busy();
  if (i == workers_.size()) throw Error("no render process is left");
  Worker& worker = workers_[i];
  if (worker.queue.empty()) worker.last_heard = std::chrono::steady_clock::now();
  worker.queue.push_back(job);
  // A process that has just died is reported by wait().
  (void)::send(worker.socket, &job, sizeof job, MSG_NOSIGNAL);
}

std::size_t WorkerPool::jobs_in_flight() const {
  std::size_t count = 0;
  for (const Worker& worker : workers_) count += worker.queue.size();
  return count;
}

WorkerEvent WorkerPool::bury(std::size_t index, const std::string& how) {
  Worker& worker = workers_[index];
  ::close(worker.socket);
  worker.socket = -1;
  const ProcessEnd end = worker.process.wait();
  WorkerEvent event;
  event.kind = WorkerEvent::Kind::kDied;
  event.job = worker.queue.empty() ? WorkerEvent::kNoJob : worker.queue.front();
  event.text = how.empty() ? how_it_ended(end) : how;
  worker.queue.clear();
  return event;
}

WorkerEvent WorkerPool::read_event(std::size_t index) {
  Worker& worker = workers_[index];
  std::string message(kMaxMessage, '\0');
  ssize_t size = -1;
  do {
    size = ::recv(worker.socket, message.data(), message.size(), 0);
    // Told once of a process that ended with jobs unread; its last message lies behind.
  } while (size < 0 && (errno == EINTR || errno == ECONNRESET));
  if (size <= 0) return bury(index, "");
  message.resize(static_cast<std::size_t>(size));
  worker.last_heard = std::chrono::steady_clock::now();
  if (message[0] == kTagFailed) {
    WorkerEvent event = bury(index, message.substr(2));
    event.kind = WorkerEvent::Kind::kFailed;
    event.exit_code = static_cast<ExitCode>(message[1]);
    return event;
  }
  WorkerEvent event;
  event.text = message.substr(1);
  event.kind = message[0] == kTagReady ? WorkerEvent::Kind::kReady : WorkerEvent::Kind::kDone;
  if (event.kind == WorkerEvent::Kind::kDone) {
    event.job = worker.queue.front();
    worker.queue.erase(worker.queue.begin());
  }
  return event;
}

std::vector<WorkerEvent> WorkerPool::wait(int timeout_ms) {
  std::vector<pollfd> polled;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    if (workers_[i].socket < 0) continue;
    polled.push_back({workers_[i].socket, POLLIN, 0});
    indices.push_back(i);
  }
  std::vector<WorkerEvent> events;
  const int ready = ::poll(polled.data(), polled.size(), timeout_ms);
  const auto now = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < polled.size(); ++i) {
    Worker& worker = workers_[indices[i]];
    if (ready > 0 && polled[i].revents != 0) {
      events.push_back(read_event(indices[i]));
    } else if (!worker.queue.empty() && std::chrono::duration<double>(now - worker.last_heard).count() > patience_s_) {
      worker.process.kill_all();
      events.push_back(bury(indices[i], "did not answer for " + std::to_string(static_cast<int>(patience_s_)) + " s"));
    }
  }
  return events;
}

}  // namespace rigproof
