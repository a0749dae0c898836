// Long calls: Python's other threads go on, Ctrl-C ends them, and `progress` is told.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <future>
#include <optional>
#include <utility>

#include "bindings.h"

namespace rigproof::python {

/// What the work asks and tells, from any thread.
class Watch {
 public:
  bool keep_going() const { return !stopped_; }
  bool tell(std::size_t done, std::size_t all) {
    done_ = done;
    all_ = all;
    return keep_going();
  }
  void stop() { stopped_ = true; }
  std::size_t done() const { return done_; }
  std::size_t all() const { return all_; }

 private:
  std::atomic<bool> stopped_ = false;
  std::atomic<std::size_t> done_ = 0, all_ = 0;
};

/// With Python's lock: signals are handled, and progress(done, all) is called; returns the exception that either
/// raised.
std::optional<py::error_already_set> look_at_python(const Watch& watch, const py::object& progress);

/// Calls `work(watch)` in a thread of its own while this one, the only one that Python tells of Ctrl-C, looks at
/// Python. What Python raised is thrown once the work has ended.
template <typename Work>
auto watched(const py::object& progress, const Work& work) {
  constexpr std::chrono::milliseconds kLook{50};
  Watch watch;
  std::optional<py::error_already_set> raised;
  auto result = std::async(std::launch::async, [&] { return work(watch); });
  {
    const py::gil_scoped_release released;
    while (result.wait_for(kLook) != std::future_status::ready) {
      if (!watch.keep_going()) continue;
      const py::gil_scoped_acquire acquired;
      raised = look_at_python(watch, progress);
      if (raised) watch.stop();
    }
  }
  if (!raised) return result.get();
  throw std::move(*raised);
}

}  // namespace rigproof::python
