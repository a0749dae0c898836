#include "external_process.h"

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

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr rlim_t kMaxFileBytes = 4ULL << 30U;
constexpr auto kPollPeriod = std::chrono::milliseconds(20);

/// The two ends of a pipe that exec closes: what the child writes there is why exec failed.
class FailurePipe {
 public:
  FailurePipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) throw Error(std::string("pipe: ") + std::strerror(errno));
  }
  ~FailurePipe() {
    close_end(0);
    close_end(1);
  }
  FailurePipe(const FailurePipe&) = delete;
  FailurePipe& operator=(const FailurePipe&) = delete;

  // Only calls that are safe between fork and exec.
  [[noreturn]] void report_and_exit() const {
    const int code = errno;
    const ssize_t ignored = write(ends_[1], &code, sizeof(code));
    static_cast<void>(ignored);
    _exit(127);
  }
  /// errno of the child, 0 once exec succeeded.
  int wait_for_exec() {
    close_end(1);
    int code = 0;
    ssize_t got = 0;
    do got = read(ends_[0], &code, sizeof(code));
    while (got < 0 && errno == EINTR);
    return got == static_cast<ssize_t>(sizeof(code)) ? code : 0;
  }

 private:
  void close_end(std::size_t end) {
    if (ends_[end] >= 0) close(ends_[end]);
    ends_[end] = -1;
  }
  std::array<int, 2> ends_ = {-1, -1};
};

bool redirect(const char* file, int flags, int descriptor) {
  const int opened = open(file, flags, 0600);
  return opened >= 0 && dup2(opened, descriptor) >= 0;
}

struct Child {
  std::vector<char*> argv;
  const char* folder;
  const char* out;
  const char* error;
};

[[noreturn]] void become(const Child& child, const FailurePipe& failure) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  signal(SIGXFSZ, SIG_DFL);  // the program ignores it and tells of the write that fails
  const rlimit files{kMaxFileBytes, kMaxFileBytes};
  const bool ready = setrlimit(RLIMIT_FSIZE, &files) == 0 && chdir(child.folder) == 0 &&
                     redirect("/dev/null", O_RDONLY, STDIN_FILENO) &&
                     redirect(child.out, O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO) &&
                     redirect(child.error, O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  if (ready) execvp(child.argv[0], child.argv.data());
  failure.report_and_exit();
}

std::string ending_in_words(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return "was ended by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
  }
  const int code = WEXITSTATUS(status);
  return code == 0 ? "" : "ended with exit code " + std::to_string(code);
}

void kill_group(pid_t child) {
  kill(-child, SIGKILL);
  kill(child, SIGKILL);
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

ProcessReport run_limited(const std::vector<std::string>& argv, const std::filesystem::path& folder,
                          const std::filesystem::path& out_file, const std::filesystem::path& error_file,
                          double time_limit_s, const std::function<bool()>& keep_going) {
  Child child{{}, folder.c_str(), out_file.c_str(), error_file.c_str()};
  std::vector<std::string> words = argv;
  for (std::string& word : words) child.argv.push_back(word.data());
  child.argv.push_back(nullptr);
  FailurePipe failure;
  const pid_t pid = fork();
  if (pid < 0) throw Error(std::string("fork: ") + std::strerror(errno), ExitCode::kTryAgain);
  if (pid == 0) become(child, failure);
  setpgid(pid, pid);
  if (const int code = failure.wait_for_exec(); code != 0) {
    wait_for(pid);
    return {"cannot be started: " + argv[0] + ": " + std::strerror(code), false};
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_limit_s);
  for (;;) {
    int status = 0;
    if (waitpid(pid, &status, WNOHANG) == pid) {
      kill(-pid, SIGKILL);  // whatever it left running
      return {ending_in_words(status), false};
    }
    const bool stop = keep_going && !keep_going();
    if (stop || std::chrono::steady_clock::now() >= end) {
      kill_group(pid);
      wait_for(pid);
      return {stop ? "was interrupted" : "ran longer than its limit of " + number_text(time_limit_s) + " s", stop};
    }
    std::this_thread::sleep_for(kPollPeriod);
  }
}

}  // namespace rigproof
