// The work of a sweep's processes, and the lines by which they report to their owner.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "jobs.h"
#include "stock.h"

namespace rigproof {

/// One line from a process.
struct JobMessage {
  std::optional<std::size_t> task;  ///< that it is at now, of those that it was given
  std::string started, done;        ///< names of methods
  std::string counted;              ///< as in SweepCounters
  std::uint64_t more = 0;           ///< of what is counted
  std::optional<std::size_t> images, images_in_all;
  bool interrupted = false;
  std::string error;  ///< what went wrong with the machine
  ExitCode exit_code = ExitCode::kBadInput;
};
/// Nothing where it is none.
JobMessage read_message(const std::string& line);

/// The work of a process that makes a set's pictures with so many processes of its own.
ForkedJobs::Work picture_work(const SweepStart& start, const PendingPictures& pictures, int processes);
/// The work of a process that runs the remaining methods of one task after the other; their answers are kept as they
/// come.
ForkedJobs::Work task_work(const SweepStart& start, std::vector<const PendingTask*> tasks);

}  // namespace rigproof
