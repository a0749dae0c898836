// Independent pieces of work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace rigproof::detection {

/// Calls work(i) for i in [0, count) on up to `threads` threads (0 = all cores), each i once, in any order. Rethrows
/// the first exception after all threads have ended. `proceed`, if given, is called from one thread at a time after
/// each piece with the number of pieces done; false stops the rest.
/// @return false if it was stopped.
bool for_each_parallel(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
                       const std::function<bool(std::size_t)>& proceed = {});

}  // namespace rigproof::detection
