#include "turn_axes.h"

#include "directions.h"
#include "rigproof/calib/vision/image_pairs.h"

namespace rigproof::rivals {

std::optional<TurnAxis> turn_axis(const Step& step, const RelativePose& pose) {
  const Eigen::Vector3d phi = so3_log(pose.T_a_b.rotation);
  const double angle = phi.norm();
  if (!step.turns() || !(angle > 0.5 * kMinTurn_rad) || !step.turns_like(angle)) return std::nullopt;
  return TurnAxis{(step.turn_rad > 0.0 ? 1.0 : -1.0) / angle * phi, angle * angle};
}

std::optional<Finding> why_no_vertical(const Observations& observations, const Recording& recording) {
  const std::size_t turns = turning_steps(observations, recording);
  if (turns >= kMinDirections) return std::nullopt;
  return Finding("method.too_few_turns", {{"turns", turns}});
}

}  // namespace rigproof::rivals
