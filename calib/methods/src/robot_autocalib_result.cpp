#include <algorithm>

#include "rival_result.h"
#include "robot_autocalib.h"

namespace rigproof::rivals {
namespace {

void report_scales(const std::vector<AutocalibSensor>& sensors, const AutocalibResult& found, Result* result) {
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    if (!found.poses[k]) {
      result->reasons.push_back(found.reasons[k]->of(sensors[k].name));
      continue;
    }
    const auto inliers = std::count(found.poses[k]->inliers.begin(), found.poses[k]->inliers.end(), true);
    result->notes.push_back(
        Finding("camera.scale_of_motions",
                {{"scale", found.poses[k]->scale}, {"agreeing", inliers}, {"motions", sensors[k].motions.size()}})
            .of(sensors[k].name));
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
