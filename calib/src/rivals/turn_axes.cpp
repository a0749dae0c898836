#include "rivals/turn_axes.h"

#include "rivals/directions.h"
#include "rivals/image_pairs.h"

namespace rigproof::rivals {

std::optional<TurnAxis> turn_axis(const Step& step, const RelativePose& pose) {
  const Eigen::Vector3d phi = so3_log(pose.T_a_b.rotation);
  const double angle = phi.norm();
  if (!step.turns() || !(angle > 0.5 * kMinTurn_rad) || !step.turns_like(angle)) return std::nullopt;
  return TurnAxis{(step.turn_rad > 0.0 ? 1.0 : -1.0) / angle * phi, angle * angle};
}

std::string why_no_vertical(const Observations& observations, const Recording& recording) {
  const std::size_t turns = turning_steps(observations, recording);
  if (turns >= kMinDirections) return {};
  return "From image to image the drive turns " + std::to_string(turns) + (turns == 1 ? " time" : " times") +
         " by 2 deg or more; three at least are needed to see where up is.";
}

}  // namespace rigproof::rivals
