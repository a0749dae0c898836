#include "rigproof/core/exclusions.h"

#include <algorithm>
#include <map>
#include <string>
#include <variant>

namespace rigproof {
namespace {

// Figures differ from frame to frame; text tells one reason from another.
bool same_reason(const Finding& a, const Finding& b) {
  const auto texts_of = [](const Finding& finding) {
    FindingValues texts;
    std::copy_if(finding.values.begin(), finding.values.end(), std::back_inserter(texts),
                 [](const FindingValue& value) { return std::holds_alternative<std::string>(value.value); });
    return texts;
  };
  return a.code == b.code && texts_of(a) == texts_of(b);
}

void leave_out_what_differs(const Finding& other, Finding* finding) {
  FindingValues& values = finding->values;
  values.erase(std::remove_if(values.begin(), values.end(),
                              [&](const FindingValue& value) {
                                const FindingValue* same = other.find(value.name);
                                return same == nullptr || !(*same == value);
                              }),
               values.end());
}

std::vector<Finding> reasons_of(const std::vector<Exclusion>& exclusions) {
  std::vector<Finding> reasons;
  for (const Exclusion& exclusion : exclusions) reasons.push_back(exclusion.why);
  return reasons;
}

// With those that are repeated in place of their repeats: what an image that is left out lacks, its repeats lack.
std::vector<Exclusion> with_originals(std::vector<Exclusion> depth) {
  std::map<std::string, Exclusion> originals;
  for (const Exclusion& exclusion : depth)
    if (!exclusion.why.is("depth.repeats")) originals.emplace(exclusion.file, exclusion);
  for (Exclusion& exclusion : depth) {
    const FindingValue* file = exclusion.why.is("depth.repeats") ? exclusion.why.find("file") : nullptr;
    // Files of observations may hold anything.
    const std::string* name = file != nullptr ? std::get_if<std::string>(&file->value) : nullptr;
    const auto original = name != nullptr ? originals.find(*name) : originals.end();
    if (original != originals.end()) exclusion = original->second;
  }
  return depth;
}

}  // namespace

std::vector<Exclusion> of_depth(const std::vector<Exclusion>& all, bool depth) {
  std::vector<Exclusion> chosen;
  std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
               [depth](const Exclusion& exclusion) { return exclusion.depth == depth; });
  return chosen;
}

std::vector<Exclusion> exclusions_of(const std::vector<Exclusion>& all, int camera) {
  std::vector<Exclusion> mine;
  std::copy_if(all.begin(), all.end(), std::back_inserter(mine),
               [camera](const Exclusion& exclusion) { return exclusion.camera == camera; });
  return mine;
}

std::vector<Finding> counted(const std::vector<Finding>& findings) {
  std::vector<std::pair<int, Finding>> groups;
  for (const Finding& finding : findings) {
    const auto known = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& group) { return same_reason(group.second, finding); });
    if (known == groups.end()) {
      groups.emplace_back(1, finding);
    } else {
      ++known->first;
      leave_out_what_differs(finding, &known->second);
    }
  }
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) {
    return std::make_pair(-a.first, a.second.code) < std::make_pair(-b.first, b.second.code);
  });
  std::vector<Finding> reasons;
  for (const auto& [count, finding] : groups) reasons.push_back(finding.with({{"count", count}}));
  return reasons;
}

Finding with_lack_of_views(Finding finding, const std::vector<Exclusion>& all, int camera) {
  const std::vector<Exclusion> images = of_depth(exclusions_of(all, camera), false);
  finding = finding.with({{"images", images.size()}});
  if (images.empty()) return finding;
  // Only what no odometry meets belongs to no stop.
  const auto without_stop =
      std::count_if(images.begin(), images.end(), [](const Exclusion& exclusion) { return exclusion.stop < 0; });
  const bool clock = 2 * static_cast<std::size_t>(without_stop) >= images.size();
  return finding.with({{"remedy", clock ? "clock" : "aim"}}).by(counted(reasons_of(images)));
}

Finding with_lack_of_depth(Finding finding, const std::vector<Exclusion>& all, int camera) {
  const std::vector<Exclusion> depth = of_depth(exclusions_of(all, camera), true);
  if (depth.empty()) return finding;
  const std::vector<Exclusion> examples = with_originals(depth);
  const Finding most = counted(reasons_of(examples)).front();
  const auto example = std::find_if(examples.begin(), examples.end(),
                                    [&most](const Exclusion& exclusion) { return same_reason(exclusion.why, most); });
  return finding.with({{"images", depth.size()}, {"file", example->file}}).by({example->why});
}

}  // namespace rigproof
