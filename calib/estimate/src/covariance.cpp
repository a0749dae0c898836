#include "rigproof/calib/estimate/covariance.h"

#include <algorithm>

#include "rigproof/core/error_jacobians.h"

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
  const RelativeJacobian of_both = relative_error_jacobian(T_robot_camera[static_cast<std::size_t>(parent)],
                                                           T_robot_camera[static_cast<std::size_t>(child)]);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, 6 * static_cast<Eigen::Index>(T_robot_camera.size()));
  J.middleCols<6>(6 * parent) = of_both.leftCols<6>();
  J.middleCols<6>(6 * child) = of_both.rightCols<6>();
  return J;
}

bool is_of_turning_point(OdometryModel model, const Observations& observations) {
  if (!observations.odometry_noise.rotation_centre_m.isZero(0.0)) return true;
  return model == OdometryModel::kPerIncrement && std::any_of(observations.stops.begin(), observations.stops.end(),
                                                              [](const Stop& stop) { return !stop.way.empty(); });
}

void add_common_errors(const PriorSigmas& priors, bool turning_point_for_origin, Eigen::MatrixXd* joint) {
  for (const CommonError& error : common_errors()) {
    if (error.along_way_only && !turning_point_for_origin) continue;
    Eigen::VectorXd common = Eigen::VectorXd::Zero(joint->rows());
    for (Eigen::Index i = error.axis; i < joint->rows(); i += 6) common[i] = priors.*error.sigma_m;
    *joint += common * common.transpose();
  }
}

}  // namespace rigproof::ml
