#include <algorithm>
#include <numeric>
#include <string>

#include "faults.h"
#include "stop_edits.h"

namespace rigproof::ml {
namespace {

// Numbers from `first` on as text sorts them, less `first`: 1, 10, 11, .., 2, 20, ..
std::vector<int> sorted_as_text(int first, std::size_t count) {
  std::vector<int> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  std::stable_sort(numbers.begin(), numbers.end(),
                   [first](int a, int b) { return std::to_string(first + a) < std::to_string(first + b); });
  return numbers;
}

Fault misordered(const Observations& observations, const std::vector<int>& cameras, const char* order,
                 const std::vector<int>& frame_at) {
  const bool all = cameras.size() == observations.cameras.size();
  Finding cause("frames.misordered", {{"order", order}});
  for (const int c : cameras)
    if (!all) cause.cameras.push_back(observations.cameras[static_cast<std::size_t>(c)].name);
  return {FaultKind::kFrames, cause, !all, [&observations, cameras, frame_at](Observations* repaired) {
            const auto stops = static_cast<int>(repaired->stops.size());
            *repaired = observations;
            move_frames(cameras, frame_at, repaired);
            *repaired = first_stops(*repaired, stops);
          }};
}

void add_orders(const Observations& observations, const std::vector<int>& cameras, std::vector<Fault>* faults) {
  const std::size_t stops = observations.stops.size();
  for (const int first : {0, 1}) {
    const std::vector<int> sorted = sorted_as_text(first, stops);
    if (!std::is_sorted(sorted.begin(), sorted.end()))
      faults->push_back(misordered(observations, cameras, "sorted as text: 1, 10, 11, .., 2, 20", sorted));
  }
  std::vector<int> backward(stops);
  std::iota(backward.rbegin(), backward.rend(), 0);
  faults->push_back(misordered(observations, cameras, "backwards", backward));
}

}  // namespace

std::vector<Fault> frame_order_faults(const Observations& observations) {
  std::vector<int> all(observations.cameras.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<Fault> faults;
  add_orders(observations, all, &faults);
  return faults;
}

std::vector<Fault> camera_order_faults(const Observations& observations, const std::vector<int>& cameras) {
  std::vector<Fault> faults;
  if (observations.cameras.size() < 2) return faults;
  for (const int c : cameras) add_orders(observations, {c}, &faults);
  return faults;
}

}  // namespace rigproof::ml
