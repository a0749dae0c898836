#include <algorithm>
#include <cstdio>

#include "rivals/rival_result.h"
#include "rivals/robot_autocalib.h"

namespace rigproof::rivals {
namespace {

void report_scales(const std::vector<AutocalibSensor>& sensors, const AutocalibResult& found, Result* result) {
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    if (!found.poses[k]) {
      result->reasons.push_back(sensors[k].name + ": " + found.reasons[k] + ".");
      continue;
    }
    const auto inliers = std::count(found.poses[k]->inliers.begin(), found.poses[k]->inliers.end(), true);
    char text[160];
    std::snprintf(text, sizeof(text), "%s: scale of its motions %.5f m a unit, %d of %d motions agree",
                  sensors[k].name.c_str(), found.poses[k]->scale, static_cast<int>(inliers),
                  static_cast<int>(sensors[k].motions.size()));
    result->notes.emplace_back(text);
  }
}

}  // namespace

Result result_of(const Observations& observations, const std::vector<AutocalibSensor>& sensors,
                 const AutocalibResult& found) {
  Result result;
  for (std::size_t k = 0; k < sensors.size(); ++k)
    if (const std::optional<AutocalibPose>& pose = found.poses[k])
      result.camera_to_robot.push_back(camera_in_robot(observations, static_cast<int>(k), pose->T_robot_sensor));
  report_scales(sensors, found, &result);
  add_pairs_from_robot(observations, &result);
  conclude_by_cameras(observations, &result);
  return result;
}

}  // namespace rigproof::rivals
