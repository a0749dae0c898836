#include "rigproof/calib/vision/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace rigproof::detection {

bool for_each_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
                       const std::function<bool(std::size_t)>& proceed) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::exception_ptr failure;
  std::size_t done = 0;
  const auto run = [&] {
    for (std::size_t i = next++; i < count && !stop; i = next++) {
      try {
        work(i);
        const std::lock_guard lock(mutex);
        ++done;
        if (proceed && !stop && !proceed(done)) stop = true;
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        stop = true;
      }
    }
  };
  const std::size_t wanted = threads > 0 ? static_cast<std::size_t>(threads) : std::thread::hardware_concurrency();
  std::vector<std::thread> pool;
  for (std::size_t i = 1; i < std::min(std::max<std::size_t>(wanted, 1), count); ++i) pool.emplace_back(run);
  run();
  for (std::thread& thread : pool) thread.join();
  if (failure) std::rethrow_exception(failure);
  return !stop;
}

}  // namespace rigproof::detection
