// The suspension's slack at one stop: height, roll and pitch are near zero.
#include "../factors.h"

namespace rigproof::ml {

void suspension(const Evaluation& at, int stop, BlockSink* sink) {
  const RobotPose& pose = at.pose(stop);
  const Eigen::Vector3d inverse(1.0 / at.noise.suspension_height_m, 1.0 / at.noise.suspension_tilt_rad,
                                1.0 / at.noise.suspension_tilt_rad);
  LocalBlock block(Group::kSuspensionHeight, 0);
  BlockRows rows(&block);
  rows.add(of_pose(stop, 3, 3), Eigen::Matrix3d(inverse.asDiagonal()));
  const Eigen::Matrix3d tilt = Eigen::Vector3d(0.0, 1.0, 1.0).asDiagonal();
  add_shared(at, {Group::kSuspensionHeight, Group::kSuspensionTilt}, tilt,
             inverse.cwiseProduct(Eigen::Vector3d(pose.height_m, pose.roll_rad, pose.pitch_rad)), rows, &block, sink);
}

}  // namespace rigproof::ml
