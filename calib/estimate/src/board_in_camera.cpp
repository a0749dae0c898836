#include "board_in_camera.h"

#include <Eigen/Cholesky>

#include "corner_model.h"
#include "rigproof/core/error.h"

namespace rigproof::ml {

namespace {

// The parts: camera, board, pose, and the odometry's factors where they are unknowns.
void add_motion(const Evaluation& at, int stop, int camera, const Eigen::Vector3d& velocity, BoardInCamera* seen) {
  RowMotion& motion = seen->motion;
  motion = row_motion(at.T_robot_camera(camera, stop), velocity, at.state.odometry_scale(),
                      at.state.odometry_yaw_factor(), at.noise.displacement_scale);
  const RigCamera& stated = at.observations.cameras[static_cast<std::size_t>(camera)];
  motion.readout_s = stated.readout_s + at.state.nuisances.of(Nuisance::kReadout, camera)[0];
  motion.rows = stated.camera.height_px;
  for (auto& part : seen->parts) part.motion.setZero();
  seen->parts[0].motion = motion.by_camera(seen->parts[0].twist);
  if (at.layout.has(Nuisance::kOdometryFactors))
    seen->parts[3].motion.block<6, 2>(6, 0) =
        motion.by_factors(at.state.odometry_scale(), at.state.odometry_yaw_factor());
}

// Of the motion's error, whitened, towards what fits the corners of the view best: Newton's, and where the loss bends
// down too much for that, that of reweighted least squares, which always goes down.
MotionVector step_of_error(const Evaluation& at, const WhitenedView& view, const BoardInCamera& seen,
                           const MotionVector& error) {
  const Camera lens = lens_at(at, view.camera);
  const double whiten = 1.0 / at.noise.corner_scale[static_cast<std::size_t>(view.camera)];
  const Eigen::Vector4d shape = at.state.nuisances.of(Nuisance::kBoardShape, view.board);
  MotionMatrix reweighted = MotionMatrix::Identity(), bent = MotionMatrix::Zero();
  MotionVector g = error;
  for (const WhitenedView::Corner& corner : view.corners) {
    const Eigen::Vector3d on_board =
        corner_of_board(at.observations.board_at(view.board), shape, corner.point_board).point;
    RowResidual residual;
    if (!row_residual(lens, seen.motion, seen.T_camera_board * on_board, corner.pixel, &residual)) continue;
    const Eigen::Matrix2d W = whiten * corner.whitening;
    const RowJacobian<2, kMotion> J = W.lazyProduct(seen.motion.by_error(residual.by_motion));
    const Eigen::Vector2d r = W * residual.value;
    const double weight = at.loss.weight(r.squaredNorm());
    const RowJacobian<2, kMotion> weighted = weight * J;
    const MotionVector slope = weighted.transpose().lazyProduct(r);
    // Small: what is made for large products took a third of a solve.
    reweighted.noalias() += weighted.transpose().lazyProduct(J);
    bent.noalias() += (2.0 / at.loss.c2) * slope.lazyProduct(slope.transpose());
    g += slope;
  }
  const Eigen::LLT<MotionMatrix> newton(reweighted - bent);
  return newton.info() == Eigen::Success ? MotionVector(-newton.solve(g)) : MotionVector(-reweighted.llt().solve(g));
}

}  // namespace

bool is_displaced(const Observations& observations, const Layout& layout, int stop, int camera) {
  const bool reads_rows =
      layout.has(Nuisance::kReadout) || observations.cameras[static_cast<std::size_t>(camera)].readout_s != 0.0;
  return reads_rows && !OdometryMotion(observations.stops[static_cast<std::size_t>(stop)]).stands();
}

BoardInCamera board_in_camera(const Evaluation& at, int stop, int camera, double after_stop_s, int board) {
  const Layout& layout = at.layout;
  const OdometryMotion motion(at.stop(stop));
  const bool at_speed = is_displaced(at.observations, layout, stop, camera);
  const bool moved = layout.has(Nuisance::kClockOffset) || after_stop_s != 0.0 || at_speed;
  const double late_s = at.state.nuisances.of(Nuisance::kClockOffset, camera)[0] - after_stop_s;
  PoseAtImage at_image{at.pose(stop)};
  if (moved)
    at_image = pose_at_image(at.pose(stop), motion, late_s, at.state.nuisances.of(Nuisance::kTurnLag)[0],
                             at.state.odometry_scale(), at.state.odometry_yaw_factor());
  ViewGeometry geometry = view_geometry(at.T_robot_camera(camera, stop), at.T_world_board(board, stop), at_image.pose);
  const ClockTwist clock = moved ? chain_to_stop(at_image, &geometry) : ClockTwist();
  BoardInCamera seen;
  seen.T_camera_board = geometry.T_camera_board;
  seen.add(at.camera_unknowns(camera, stop), geometry.twist_by_camera);
  seen.add(at.board_unknowns(board, stop), geometry.twist_by_board);
  seen.add(of_pose(stop), geometry.twist_by_pose);
  const auto add = [&](Nuisance nuisance, const auto& twist) {
    if (moved && layout.has(nuisance))
      seen.add(of_globals(layout.place(nuisance, camera), row_of(nuisance).size()), twist);
  };
  add(Nuisance::kOdometryFactors, clock.by_factors);
  add(Nuisance::kClockOffset, clock.by_clock_offset);
  add(Nuisance::kTurnLag, clock.by_turn_lag);
  if (at_speed) add_motion(at, stop, camera, motion.velocity_after(after_stop_s), &seen);
  return seen;
}

BoardInCamera board_in_view(const Evaluation& at, const WhitenedView& view) {
  constexpr int kMostRounds = 30;
  constexpr double kSettled = 1e-4;  // of a standard deviation: the last step leaves its square
  BoardInCamera seen = board_in_camera(at, view.stop, view.camera, view.after_stop_s, view.board);
  RowMotion& motion = seen.motion;
  if (!motion.moves()) return seen;
  MotionVector error = MotionVector::Zero();
  MotionVector step = MotionVector::Ones();
  for (int round = 0; round < kMostRounds && step.norm() > kSettled; ++round) {
    step = step_of_error(at, view, seen, error);
    error += step;
    motion.set_error(error);
  }
  seen.parts[0].motion = motion.by_camera(seen.parts[0].twist);
  return seen;
}

DisplacementRows TwistSystem::displacement(const RowMotion& motion) const {
  constexpr int kParts = DisplacementRows::kParts;
  const MotionMatrix covariance = motion.covariance_of_error(motion_H_);
  const RowJacobian<kParts, kMotion> by_known = -covariance.topRows<kParts>() * motion.by_error().transpose();
  DisplacementRows rows;
  rows.by_twist = by_known * motion_by_twist_;
  rows.by_motion = by_known * motion_H_;
  rows.by_direct = by_known * motion_by_direct_;
  rows.residual = motion.error.head<kParts>();
  rows.unknown = covariance.topLeftCorner<kParts, kParts>().trace();
  return rows;
}

void TwistSystem::eliminate_error(const RowMotion& motion) {
  const MotionMatrix covariance = motion.covariance(motion_H_);
  H_ -= motion_by_twist_.transpose() * covariance * motion_by_twist_;
  by_twist_ -= motion_by_direct_.transpose() * covariance * motion_by_twist_;
  by_direct_ -= motion_by_direct_.transpose() * covariance * motion_by_direct_;
  const MotionMatrix left = MotionMatrix::Identity() - motion_H_ * covariance;
  motion_by_twist_ = (left * motion_by_twist_).eval();
  motion_by_direct_ = (left * motion_by_direct_).eval();
  motion_H_ = (left * motion_H_).eval();
}

int TwistSystem::append(const Layout& layout, Nuisance nuisance, int which) {
  if (!layout.has(nuisance)) return -1;
  const int first = direct_, size = row_of(nuisance).size();
  if (first + size > kMaxDirect || count_ == static_cast<int>(segments_.size()))
    throw Error("estimate: the residuals of a view know too many unknowns directly");
  segments_[static_cast<std::size_t>(count_++)] = of_globals(layout.place(nuisance, which), size);
  direct_ += size;
  return first;
}

void TwistSystem::chain(const BoardInCamera& seen, LocalBlock* block) const {
  const bool moves = seen.motion.moves();
  std::array<Matrix6d, 6> H_by;
  std::array<MotionBy6, 6> motion_by;
  std::array<int, 6> start;
  for (std::size_t a = 0; a < static_cast<std::size_t>(seen.count); ++a) {
    const auto& [segment, T, M] = seen.parts[a];
    start[a] = block->append(segment);
    H_by[a].noalias() = H_ * T;
    if (moves) {
      H_by[a].noalias() += motion_by_twist_.transpose() * M;
      motion_by[a] = motion_by_twist_ * T + motion_H_ * M;
    }
    for (std::size_t b = 0; b <= a; ++b) {
      const int columns = seen.parts[b].segment.size;
      if (!moves && segment.size == 6 && columns == 6) {
        block->H.block<6, 6>(start[a], start[b]).noalias() = T.transpose() * H_by[b];
        continue;
      }
      Matrix6d product = T.transpose() * H_by[b];
      if (moves) product.noalias() += M.transpose() * motion_by[b];
      block->H.block(start[a], start[b], segment.size, columns) = product.topLeftCorner(segment.size, columns);
    }
    Vector6d g = T.transpose() * g_;
    if (moves) g += M.transpose() * motion_g_;
    block->g.segment(start[a], segment.size) = g.head(segment.size);
  }
  if (direct_ == 0) return;
  const int first = block->unknowns;
  for (int s = 0; s < count_; ++s) block->append(segments_[static_cast<std::size_t>(s)]);
  for (std::size_t b = 0; b < static_cast<std::size_t>(seen.count); ++b) {
    const auto& [segment, T, M] = seen.parts[b];
    for (int i = 0; i < direct_; ++i) {
      Eigen::Matrix<double, 1, 6> row = by_twist_.row(i) * T;
      if (moves) row += motion_by_direct_.col(i).transpose() * M;
      for (int j = 0; j < segment.size; ++j) block->H(first + i, start[b] + j) = row[j];
    }
  }
  block->H.block(first, first, direct_, direct_) = by_direct_.topLeftCorner(direct_, direct_);
  block->g.segment(first, direct_) = direct_g_.head(direct_);
}

}  // namespace rigproof::ml
