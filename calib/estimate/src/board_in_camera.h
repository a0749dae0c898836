// The board as a camera sees it at the time of an image: the twist that all unknowns of corners and board planes enter
// by.
#pragma once

#include <array>

#include "factors.h"
#include "row_motion.h"

namespace rigproof::ml {

struct BoardInCamera {
  /// Derivative of the board's twist in the camera by the first `segment.size` columns' unknowns.
  struct Part {
    Segment segment;
    Matrix6d twist;
    MotionBy6 motion;  ///< the same of the motion's twist, where there is a motion
  };
  Rigid3 T_camera_board;  ///< when the middle row is read
  RowMotion motion;
  std::array<Part, 6> parts;  ///< camera, board, pose; for images that are not of their stop's time odometry and clocks
  int count = 0;

  template <typename Twist>
  void add(const Segment& segment, const Twist& twist) {
    Part& part = parts[static_cast<std::size_t>(count++)];
    part.segment = segment;
    part.twist.leftCols<Twist::ColsAtCompileTime>() = twist;
    part.twist.rightCols<6 - Twist::ColsAtCompileTime>().setZero();
  }
};

/// Whether the image of a camera at a stop was taken at speed and is treated so: where the readout is stated to be none
/// at all, images are taken as they are.
bool is_displaced(const Observations& observations, const Layout& layout, int stop, int camera);
/// @param after_stop_s by how much the image is later than the stop, by the stamps @param board which of them
BoardInCamera board_in_camera(const Evaluation& at, int stop, int camera, double after_stop_s, int board);
/// The same, of an image taken at speed with the motion by which the view's corners fit best.
BoardInCamera board_in_view(const Evaluation& at, const WhitenedView& view);

/// By how much the image of a view that is taken at speed is displaced, as it fits best: six whitened residuals of the
/// estimate, and how they change with what the view's corners know.
struct DisplacementRows {
  static constexpr int kParts = 6, kMaxDirect = 16;
  RowJacobian<kParts, 6> by_twist;
  RowJacobian<kParts, kMotion> by_motion;
  RowJacobian<kParts, kMaxDirect> by_direct;
  Eigen::Matrix<double, kParts, 1> residual;
  double unknown = 0.0;  ///< sum of their variances if all but the displacement were known
};

/// Residuals of one view: summed up on the twist and on unknowns that they know directly, then chained to all others.
class TwistSystem {
 public:
  static constexpr int kMaxDirect = DisplacementRows::kMaxDirect;

  /// Unknowns that the residuals know directly. Returns their first column, -1 where they are believed.
  /// @param which camera or board
  int append(const Layout& layout, Nuisance nuisance, int which);

  /// @param J by the twist @param direct by the appended unknowns
  template <int kRows>
  void add(const RowJacobian<kRows, 6>& J, const RowJacobian<kRows, kMaxDirect>& direct,
           const Eigen::Matrix<double, kRows, 1>& r, double factor) {
    const auto weighted = (factor * J.transpose()).eval();
    H_.noalias() += weighted.lazyProduct(J);
    g_.noalias() += weighted.lazyProduct(r);
    for (int i = 0; i < direct_; ++i) {
      const Eigen::Matrix<double, 1, kRows> by = factor * direct.col(i).transpose();
      by_twist_.row(i) += by * J;
      for (int j = 0; j < direct_; ++j) by_direct_(i, j) += by.dot(direct.col(j));
      direct_g_[i] += by.dot(r);
    }
  }

  /// The same of residuals that know the motion while rows are read.
  template <int kRows>
  void add(const RowJacobian<kRows, 6>& J, const RowJacobian<kRows, kMotion>& by_motion,
           const RowJacobian<kRows, kMaxDirect>& direct, const Eigen::Matrix<double, kRows, 1>& r, double factor) {
    add<kRows>(J, direct, r, factor);
    const auto weighted = (factor * by_motion.transpose()).eval();
    motion_by_twist_.noalias() += weighted.lazyProduct(J);
    motion_H_.noalias() += weighted.lazyProduct(by_motion);
    motion_g_.noalias() += weighted.lazyProduct(r);
    for (int i = 0; i < direct_; ++i) motion_by_direct_.col(i) += weighted * direct.col(i);
  }
  /// What the view tells of its displacement, before that is eliminated.
  DisplacementRows displacement(const RowMotion& motion) const;
  void add(const DisplacementRows& rows, double factor) {
    add<DisplacementRows::kParts>(rows.by_twist, rows.by_motion, rows.by_direct, rows.residual, factor);
  }
  /// Takes out what the error of the motion explains. At its best value its own gradient is zero.
  void eliminate_error(const RowMotion& motion);

  /// Appends all unknowns to the block and fills its H and g.
  void chain(const BoardInCamera& seen, LocalBlock* block) const;

 private:
  Matrix6d H_ = Matrix6d::Zero();
  Vector6d g_ = Vector6d::Zero();
  int direct_ = 0, count_ = 0;
  std::array<Segment, 5> segments_;  // of the direct unknowns
  RowJacobian<kMaxDirect, 6> by_twist_ = RowJacobian<kMaxDirect, 6>::Zero();
  Eigen::Matrix<double, kMaxDirect, kMaxDirect> by_direct_ = Eigen::Matrix<double, kMaxDirect, kMaxDirect>::Zero();
  Eigen::Matrix<double, kMaxDirect, 1> direct_g_ = Eigen::Matrix<double, kMaxDirect, 1>::Zero();
  MotionMatrix motion_H_ = MotionMatrix::Zero();
  MotionBy6 motion_by_twist_ = MotionBy6::Zero();
  MotionVector motion_g_ = MotionVector::Zero();
  Eigen::Matrix<double, kMotion, kMaxDirect> motion_by_direct_ = Eigen::Matrix<double, kMotion, kMaxDirect>::Zero();
};

}  // namespace rigproof::ml
