#include "rigproof/calib/estimate/covariance.h"

namespace rigproof::ml {

Eigen::MatrixXd camera_chart(const State& state, const Layout& layout) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6 * layout.cameras, layout.globals());
  for (int c = 0; c < layout.cameras; ++c) {
    J.block<3, 3>(6 * c, layout.camera(c)).setIdentity();
    J.block<3, 3>(6 * c + 3, layout.camera(c) + 3) =
        state.T_robot_camera[static_cast<std::size_t>(c)].rotation_matrix();
  }
  return J;
}

Eigen::MatrixXd pair_chart(const std::vector<Rigid3>& T_robot_camera, int parent, int child) {
  const Rigid3& Xj = T_robot_camera[static_cast<std::size_t>(parent)];
  const Rigid3& Xk = T_robot_camera[static_cast<std::size_t>(child)];
  const Eigen::Matrix3d Rt = Xj.rotation_matrix().transpose();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, 6 * static_cast<Eigen::Index>(T_robot_camera.size()));
  // t_jk = R_j^T (t_k - t_j), and turning the parent by w turns what it sees by -w.
  J.block<3, 3>(0, 6 * parent) = -Rt;
  J.block<3, 3>(0, 6 * parent + 3) = Rt * skew(Xk.translation - Xj.translation);
  J.block<3, 3>(3, 6 * parent + 3) = -Rt;
  J.block<3, 3>(0, 6 * child) = Rt;
  J.block<3, 3>(3, 6 * child + 3) = Rt;
  return J;
}

void add_common_errors(const PriorSigmas& priors, bool along_way, Eigen::MatrixXd* joint) {
  for (const CommonError& error : common_errors()) {
    if (error.along_way_only && !along_way) continue;
    Eigen::VectorXd common = Eigen::VectorXd::Zero(joint->rows());
    for (Eigen::Index i = error.axis; i < joint->rows(); i += 6) common[i] = priors.*error.sigma_m;
    *joint += common * common.transpose();
  }
}

}  // namespace rigproof::ml
