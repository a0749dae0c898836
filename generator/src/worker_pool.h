// Processes that work through numbered jobs. Rendering in processes is faster than in threads, and one that crashes
// takes nobody with it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/core/child_process.h"
#include "rigproof/core/error.h"

namespace rigproof {

/// What a process reports.
struct WorkerEvent {
  enum class Kind {
    kReady,   ///< prepared; text is its greeting
    kDone,    ///< text is the job's result
    kFailed,  ///< an exception, text is its message; the process has ended
    kDied,    ///< the process ended by itself or hangs; text says how
  };
  Kind kind = Kind::kDone;
  std::uint32_t job = 0;  ///< kDone: which; kFailed, kDied: the first unfinished one, or kNoJob
  std::string text;
  ExitCode exit_code = ExitCode::kBadInput;  ///< kFailed: that of the exception

  static constexpr std::uint32_t kNoJob = 0xFFFFFFFFU;
};

/// Forks its processes in the constructor, when no other thread of this module runs yet. They end when the pool, or the
/// process that owns it, ends in whatever way.
class WorkerPool {
 public:
  /// Runs one job in the process and returns its result.
  using Handler = std::function<std::string(std::uint32_t)>;
  /// Runs in the process before its first job; writes a greeting.
  using Prepare = std::function<Handler(std::string* greeting)>;

  /// @param patience_s a process that is silent for longer while it has work counts as dead
  WorkerPool(int processes, const Prepare& prepare, double patience_s);
  /// Ends the processes: each after its job in work, so that no file stays half-written, or after 10 s.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// True if some living process has fewer jobs queued than keeps it busy.
  bool wants_job() const;
  /// Hands a job to the process with the fewest.
  void submit(std::uint32_t job);
  std::size_t jobs_in_flight() const;
  /// What has happened; empty after timeout_ms.
  std::vector<WorkerEvent> wait(int timeout_ms);

 private:
  struct Worker {
    ChildProcess process;
    int socket = -1;  ///< -1 once it has ended
    std::vector<std::uint32_t> queue;
    std::chrono::steady_clock::time_point last_heard;
  };

  void start(const Prepare& prepare);
  WorkerEvent read_event(std::size_t index);
  WorkerEvent bury(std::size_t index, const std::string& how);
  std::size_t least_busy() const;

  double patience_s_;
  std::vector<Worker> workers_;
};

}  // namespace rigproof
