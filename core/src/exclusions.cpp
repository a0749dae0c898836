#include "rigproof/core/exclusions.h"

#include <algorithm>
#include <map>

namespace rigproof {
namespace {

// What stands in brackets differs from frame to frame.
std::string without_brackets(const std::string& reason) { return reason.substr(0, reason.find(" (")); }

}  // namespace

bool concerns_depth(const Exclusion& exclusion) { return exclusion.reason.rfind(kDepthReason, 0) == 0; }

std::vector<ReasonGroup> by_reason(const std::vector<Exclusion>& left_out) {
  std::map<std::string, std::vector<const Exclusion*>> alike;
  for (const Exclusion& exclusion : left_out) alike[without_brackets(exclusion.reason)].push_back(&exclusion);
  std::vector<ReasonGroup> groups;
  for (const auto& [reason, exclusions] : alike) {
    const std::string& whole = exclusions.front()->reason;
    const bool same = std::all_of(exclusions.begin(), exclusions.end(),
                                  [&whole](const Exclusion* exclusion) { return exclusion->reason == whole; });
    groups.push_back({same ? whole : reason, {}});
    for (const Exclusion* exclusion : exclusions) groups.back().stops.push_back(exclusion->stop);
  }
  std::stable_sort(groups.begin(), groups.end(),
                   [](const ReasonGroup& a, const ReasonGroup& b) { return a.stops.size() > b.stops.size(); });
  return groups;
}

std::vector<Exclusion> of_depth(const std::vector<Exclusion>& all, bool depth) {
  std::vector<Exclusion> chosen;
  std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
               [depth](const Exclusion& exclusion) { return concerns_depth(exclusion) == depth; });
  return chosen;
}

std::vector<Exclusion> exclusions_of(const std::vector<Exclusion>& all, int camera) {
  std::vector<Exclusion> mine;
  std::copy_if(all.begin(), all.end(), std::back_inserter(mine),
               [camera](const Exclusion& exclusion) { return exclusion.camera == camera; });
  return mine;
}

std::string why_no_view(const std::vector<Exclusion>& all, int camera) {
  constexpr std::size_t kShown = 3;
  const std::vector<Exclusion> images = of_depth(exclusions_of(all, camera), false);
  if (images.empty()) return "the board is in none of its images";
  const std::vector<ReasonGroup> groups = by_reason(images);
  std::string reasons;
  for (std::size_t i = 0; i < groups.size() && i < kShown; ++i)
    reasons +=
        (i == 0 ? "" : ", ") + std::to_string(groups[i].stops.size()) + ": " + without_brackets(groups[i].reason);
  if (groups.size() > kShown) reasons += ", ..";
  // Only what no odometry meets belongs to no stop.
  const auto without_stop =
      std::count_if(images.begin(), images.end(), [](const Exclusion& exclusion) { return exclusion.stop < 0; });
  const bool clock = 2 * static_cast<std::size_t>(without_stop) >= images.size();
  return "none of its " + std::to_string(images.size()) + " images is used (" + reasons + "); " +
         (clock ? "give stamps in seconds of the odometry's clock, and odometry beside them"
                : "let it see the whole board");
}

std::string why_no_depth(const std::vector<Exclusion>& all, int camera) {
  const std::vector<Exclusion> depth = of_depth(exclusions_of(all, camera), true);
  if (depth.empty()) return "";
  const std::string most = without_brackets(by_reason(depth).front().reason);
  const auto example = std::find_if(depth.begin(), depth.end(), [&most](const Exclusion& exclusion) {
    return without_brackets(exclusion.reason) == most;
  });
  return ": depth of " + std::to_string(depth.size()) + " images is left out, as of " + example->file + ": " +
         example->reason.substr(std::string(kDepthReason).size());
}

}  // namespace rigproof
