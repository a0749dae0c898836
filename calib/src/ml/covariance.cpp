#include "ml/covariance.h"

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

namespace {

void add_common_error(Eigen::Index axis, double sigma, Eigen::MatrixXd* joint) {
  Eigen::VectorXd common = Eigen::VectorXd::Zero(joint->rows());
  for (Eigen::Index i = axis; i < joint->rows(); i += 6) common[i] = sigma;
  *joint += common * common.transpose();
}

}  // namespace

void add_rotation_centre(double sigma_m, Eigen::MatrixXd* joint) { add_common_error(0, sigma_m, joint); }

void add_riding_height(double sigma_m, Eigen::MatrixXd* joint) { add_common_error(2, sigma_m, joint); }

}  // namespace rigproof::ml
