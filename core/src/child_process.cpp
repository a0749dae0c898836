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

  // Only calls that are safe between fork and exec.
  int report(int code) const {
    const ssize_t ignored = write(ends_[1], &code, sizeof(code));
    static_cast<void>(ignored);
    return 127;
  }
  // errno of the child, 0 once exec succeeded.
  int wait_for_exec() {
    close(std::exchange(ends_[1], -1));
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
  if (!is_running() || waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
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
  ChildProcess child([&] {
    become_program(argv.data(), run);
    return failure.report(errno);
  });
  if (const int code = failure.wait_for_exec(); code != 0)
    return {"cannot be started: " + run.argv[0] + ": " + std::strerror(code), false};
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(run.time_limit_s);
  for (;;) {
    if (const std::optional<ProcessEnd> ended = child.poll()) {
      child.kill_all();  // whatever it left running
      return {ended->is_good() ? "" : ended->in_words(), false};
    }
    const bool stop = run.keep_going && !run.keep_going();
    if (stop) return {"was interrupted", true};
    if (std::chrono::steady_clock::now() >= end)
      return {"ran longer than its limit of " + number_text(run.time_limit_s) + " s", false};
    std::this_thread::sleep_for(kPollPeriod);
  }
}

}  // namespace rigproof
