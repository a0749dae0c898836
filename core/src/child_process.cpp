#include "rigproof/core/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <string_view>
#include <thread>
#include <utility>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr int kUncaught = 70;
constexpr rlim_t kMaxFileBytes = 4ULL << 30U;
constexpr auto kPollPeriod = std::chrono::milliseconds(20);

// Never returns: what the owner would do at its end is not the child's to do.
[[noreturn]] void become_child(pid_t owner, const std::function<int()>& work) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != owner) _exit(kUncaught);
  try {
    _exit(work());
  } catch (...) {
    _exit(kUncaught);
  }
}

ProcessEnd end_of(int status) {
  return WIFSIGNALED(status) ? ProcessEnd{WTERMSIG(status), 0} : ProcessEnd{0, WEXITSTATUS(status)};
}

// The two ends of a pipe that exec closes: what the child writes there is why exec failed.
class FailurePipe {
 public:
  FailurePipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) throw Error(std::string("pipe: ") + std::strerror(errno));
  }
  ~FailurePipe() {
    for (const int end : ends_)
      if (end >= 0) close(end);
  }
  FailurePipe(const FailurePipe&) = delete;
  FailurePipe& operator=(const FailurePipe&) = delete;

  // For a process that execs nothing, whose end would stay open.
  void leave() { close(std::exchange(ends_[1], -1)); }
  // Only calls that are safe between fork and exec.
  int report(int code) const {
    const ssize_t ignored = write(ends_[1], &code, sizeof(code));
    static_cast<void>(ignored);
    return 127;
  }
  // errno of the child, 0 once exec succeeded.
  int wait_for_exec() {
    leave();
    int code = 0;
    ssize_t got = 0;
    do got = read(ends_[0], &code, sizeof(code));
    while (got < 0 && errno == EINTR);
    return got == static_cast<ssize_t>(sizeof(code)) ? code : 0;
  }

 private:
  std::array<int, 2> ends_ = {-1, -1};
};

bool redirect(const char* file, int flags, int descriptor) {
  const int opened = open(file, flags, 0600);
  return opened >= 0 && dup2(opened, descriptor) >= 0;
}

// Returns only if it fails. Only calls that are safe between fork and exec.
void become_program(char* const* argv, const ProgramRun& run) {
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
  signal(SIGXFSZ, SIG_DFL);  // our own program ignores it and tells of the write that fails
  const rlimit files{kMaxFileBytes, kMaxFileBytes};
  if (setrlimit(RLIMIT_FSIZE, &files) == 0 && chdir(run.folder.c_str()) == 0 &&
      redirect("/dev/null", O_RDONLY, STDIN_FILENO) && redirect(run.out_file.c_str(), kWrite, STDOUT_FILENO) &&
      redirect(run.error_file.c_str(), kWrite, STDERR_FILENO))
    execvp(argv[0], argv);
}

// What came of the program and has no parent any more: those are children of the keeper. Only calls that are safe
// between fork and exec.
void kill_children() {
  const int list = open("/proc/thread-self/children", O_RDONLY | O_CLOEXEC);
  if (list < 0) return;
  std::array<char, 4096> text{};
  pid_t pid = 0;
  for (ssize_t count = 0; (count = read(list, text.data(), text.size())) > 0;) {
    for (const char c : std::string_view(text.data(), static_cast<std::size_t>(count))) {
      if (c != ' ') {
        pid = 10 * pid + (c - '0');
        continue;
      }
      kill(pid, SIGKILL);
      pid = 0;
    }
  }
  close(list);
}

// Each that ends may leave children of its own; one that cannot be killed is waited for in vain.
void end_children(pid_t group) {
  constexpr int kMostRounds = 5000;
  constexpr timespec kRound{0, 1000000};
  kill(-group, SIGKILL);
  for (int round = 0; round < kMostRounds; ++round) {
    kill_children();
    pid_t ended = 0;
    while ((ended = waitpid(-1, nullptr, WNOHANG)) > 0) {
    }
    if (ended < 0 && errno == ECHILD) return;
    nanosleep(&kRound, nullptr);
  }
}

// Waits until the program ends, or the owner does or wants it to end.
// @return its wait status; nothing if it still runs
std::optional<int> wait_for_program(pid_t program, const sigset_t& watched) {
  for (;;) {
    int status = 0;
    const pid_t ended = waitpid(-1, &status, WNOHANG);
    if (ended == program) return status;
    if (ended > 0) continue;
    if (sigwaitinfo(&watched, nullptr) == SIGTERM) return std::nullopt;
  }
}

// Ends as the program did.
[[noreturn]] void end_like(int status) {
  if (WIFSIGNALED(status)) {
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);  // the program's own is enough
    signal(WTERMSIG(status), SIG_DFL);
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_UNBLOCK, &all, nullptr);
    raise(WTERMSIG(status));
  }
  _exit(WEXITSTATUS(status));
}

// Keeps hold of everything that the program starts, in whatever session of its own (a daemon leaves its group and its
// parent), and ends it all with the program, at SIGTERM, and when the owner ends. Only calls that are safe between fork
// and exec.
[[noreturn]] void keep(char* const* argv, const ProgramRun& run, FailurePipe* failure) {
  sigset_t watched, before;
  sigemptyset(&watched);
  sigaddset(&watched, SIGTERM);
  sigaddset(&watched, SIGCHLD);
  sigprocmask(SIG_BLOCK, &watched, &before);
  signal(SIGCHLD, SIG_DFL);  // ignored, it would reap the program unseen
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const pid_t keeper = getpid(), program = fork();
  if (program < 0) _exit(failure->report(errno));
  setpgid(program,
          program);  // a script that ends its group must not end the keeper; done on both sides, as either may be first
  if (program == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != keeper) _exit(kUncaught);
    sigprocmask(SIG_SETMASK, &before, nullptr);
    become_program(argv, run);
    _exit(failure->report(errno));
  }
  failure->leave();
  const std::optional<int> status = wait_for_program(program, watched);
  end_children(program);
  if (status) end_like(*status);
  _exit(kUncaught);
}

}  // namespace

std::string ProcessEnd::in_words() const {
  return signal != 0 ? "was ended by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")"
                     : "ended with exit code " + std::to_string(exit_code);
}

ChildProcess::ChildProcess(const std::function<int()>& work) {
  const pid_t owner = getpid();
  pid_ = fork();
  if (pid_ < 0) throw Error(std::string("fork: ") + std::strerror(errno), ExitCode::kTryAgain);
  if (pid_ == 0) become_child(owner, work);
  group_ = pid_;
  setpgid(pid_, pid_);
}

ChildProcess::~ChildProcess() {
  if (!is_running()) return;
  kill_all();
  wait();
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), group_(std::exchange(other.group_, -1)) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(group_, other.group_);
  return *this;
}

std::optional<ProcessEnd> ChildProcess::poll() {
  int status = 0;
  if (!is_running()) return std::nullopt;
  const pid_t ended = waitpid(pid_, &status, WNOHANG);
  const bool reaped = ended < 0 && errno == ECHILD;  // where SIGCHLD is ignored the system does it
  if (ended != pid_ && !reaped) return std::nullopt;
  pid_ = -1;
  return end_of(status);
}

ProcessEnd ChildProcess::wait() {
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  return end_of(status);
}

void ChildProcess::send(int signal) const {
  if (is_running()) kill(pid_, signal);
}

void ChildProcess::kill_all() const {
  if (group_ > 0) kill(-group_, SIGKILL);
  send(SIGKILL);
}

ProgramReport run_program(const ProgramRun& run) {
  std::vector<std::string> words = run.argv;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  FailurePipe failure;
  ChildProcess keeper([&]() -> int { keep(argv.data(), run, &failure); });
  if (const int code = failure.wait_for_exec(); code != 0)
    return {"cannot be started: " + run.argv[0] + ": " + std::strerror(code), false};
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(run.time_limit_s);
  for (;;) {
    if (const std::optional<ProcessEnd> ended = keeper.poll())
      return {ended->is_good() ? "" : ended->in_words(), false};
    const bool stop = run.keep_going && !run.keep_going(), too_long = std::chrono::steady_clock::now() >= end;
    if (!stop && !too_long) {
      std::this_thread::sleep_for(kPollPeriod);
      continue;
    }
    keeper.send(SIGTERM);
    keeper.wait();
    if (stop) return {"was interrupted", true};
    return {"ran longer than its limit of " + number_text(run.time_limit_s) + " s", false};
  }
}

}  // namespace rigproof
