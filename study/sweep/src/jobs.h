// Pieces of work, each in its own process: a crash affects no other piece, and none leaves anything in memory that the
// next one could depend on.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rigproof/core/child_process.h"

namespace rigproof {

/// Forks a process for each job. The owner must be single-threaded while it does.
class ForkedJobs {
 public:
  /// Sends a line (without line feed) to the owner.
  using Tell = std::function<void(const std::string& line)>;
  /// What the process does; it ends with its return.
  using Work = std::function<void(const Tell& tell)>;

  struct News {
    std::size_t job = 0;
    bool ended = false;
    std::string line;  ///< what it told
    ProcessEnd end;    ///< how
  };

  ForkedJobs() = default;
  /// Ends all jobs.
  ~ForkedJobs() { stop(); }
  ForkedJobs(const ForkedJobs&) = delete;
  ForkedJobs& operator=(const ForkedJobs&) = delete;

  void start(std::size_t job, const Work& work);
  std::size_t running() const { return children_.size(); }
  /// Lines of each job in the order in which it sent them, then its end; empty after timeout_ms.
  std::vector<News> wait(int timeout_ms);
  /// Asks all jobs to end (SIGTERM), and ends those that do not within two seconds.
  void stop();

 private:
  struct Child {
    ChildProcess process;
    int pipe = -1;
    std::string unread;  ///< the beginning of a line
  };

  void read_from(std::size_t job, Child* child, std::vector<News>* news);

  std::map<std::size_t, Child> children_;
};

}  // namespace rigproof
