#include "rigproof/calib/estimate/board_place.h"

namespace rigproof::ml {

Eigen::MatrixXd PlaceError::by_globals(const Layout& layout) const {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(6, layout.globals());
  J.middleCols<6>(layout.board(0)) = by_first;
  J.middleCols<6>(layout.board(board)) = by_board;
  return J;
}

// With steps t <- t + d, R <- R Exp(phi) of both poses: of E = R0^T R1^T R, Log(E) changes by the right Jacobian's
// inverse times phi of this board, and by the left one's times R0^T phi of the first, which turns the other way.
PlaceError place_error(const State& state, int board, const BoardPlace& place) {
  const Rigid3& T_world_first = state.T_world_board.front();
  const Rigid3 T_first_board = T_world_first.inverse() * state.T_world_board[static_cast<std::size_t>(board)];
  const Eigen::Matrix3d R_first_world = T_world_first.rotation_matrix().transpose();
  const Eigen::Vector3d turn = so3_log(place.T_first_board.rotation.conjugate() * T_first_board.rotation);
  PlaceError error;
  error.board = board;
  error.value << T_first_board.translation - place.T_first_board.translation, turn;
  error.sigma << Eigen::Vector3d::Constant(place.sigma_m), Eigen::Vector3d::Constant(place.sigma_rad);
  error.by_first.setZero();
  error.by_first.topLeftCorner<3, 3>() = -R_first_world;
  error.by_first.topRightCorner<3, 3>() = skew(T_first_board.translation);
  error.by_first.bottomRightCorner<3, 3>() =
      -so3_left_jacobian_inverse(turn) * place.T_first_board.rotation_matrix().transpose();
  error.by_board.setZero();
  error.by_board.topLeftCorner<3, 3>() = R_first_world;
  error.by_board.bottomRightCorner<3, 3>() = so3_left_jacobian_inverse(-turn);
  return error;
}

}  // namespace rigproof::ml
