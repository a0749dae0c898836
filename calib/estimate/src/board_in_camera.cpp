#include "board_in_camera.h"

#include "rigproof/core/error.h"

namespace rigproof::ml {

BoardInCamera board_in_camera(const Evaluation& at, int stop, int camera, double after_stop_s) {
  const Layout& layout = at.layout;
  const bool moved = layout.has(Nuisance::kClockOffset) || after_stop_s != 0.0;
  PoseAtImage at_image{at.pose(stop)};
  if (moved)
    at_image = pose_at_image(
        at.pose(stop), at.stop(stop).velocity, at.state.nuisances.of(Nuisance::kClockOffset, camera)[0] - after_stop_s,
        at.state.nuisances.of(Nuisance::kTurnLag)[0], at.state.odometry_scale(), at.state.odometry_yaw_factor());
  ViewGeometry geometry = view_geometry(at.T_robot_camera(camera, stop), at.T_world_board(stop), at_image.pose);
  const ClockTwist clock = moved ? chain_to_stop(at_image, &geometry) : ClockTwist();
  BoardInCamera seen;
  seen.T_camera_board = geometry.T_camera_board;
  seen.add(at.camera_unknowns(camera, stop), geometry.twist_by_camera);
  seen.add(at.board_unknowns(stop), geometry.twist_by_board);
  seen.add(of_pose(stop), geometry.twist_by_pose);
  const auto add = [&](Nuisance nuisance, const auto& twist) {
    if (moved && layout.has(nuisance))
      seen.add(of_globals(layout.place(nuisance, camera), row_of(nuisance).size()), twist);
  };
  add(Nuisance::kOdometryFactors, clock.by_factors);
  add(Nuisance::kClockOffset, clock.by_clock_offset);
  add(Nuisance::kTurnLag, clock.by_turn_lag);
  return seen;
}

int TwistSystem::append(const Layout& layout, Nuisance nuisance, int camera) {
  if (!layout.has(nuisance)) return -1;
  const int first = direct_, size = row_of(nuisance).size();
  if (first + size > kMaxDirect || count_ == static_cast<int>(segments_.size()))
    throw Error("estimate: the residuals of a view know too many unknowns directly");
  segments_[static_cast<std::size_t>(count_++)] = of_globals(layout.place(nuisance, camera), size);
  direct_ += size;
  return first;
}

void TwistSystem::chain(const BoardInCamera& seen, LocalBlock* block) const {
  std::array<Matrix6d, 6> H_by;
  std::array<int, 6> start;
  for (std::size_t a = 0; a < static_cast<std::size_t>(seen.count); ++a) {
    const auto& [segment, T] = seen.parts[a];
    start[a] = block->append(segment);
    H_by[a].noalias() = H_ * T;
    for (std::size_t b = 0; b <= a; ++b) {
      const int columns = seen.parts[b].segment.size;
      if (segment.size == 6 && columns == 6) {
        block->H.block<6, 6>(start[a], start[b]).noalias() = T.transpose() * H_by[b];
        continue;
      }
      const Matrix6d product = T.transpose() * H_by[b];
      block->H.block(start[a], start[b], segment.size, columns) = product.topLeftCorner(segment.size, columns);
    }
    const Vector6d g = T.transpose() * g_;
    block->g.segment(start[a], segment.size) = g.head(segment.size);
  }
  if (direct_ == 0) return;
  const int first = block->unknowns;
  for (int s = 0; s < count_; ++s) block->append(segments_[static_cast<std::size_t>(s)]);
  for (std::size_t b = 0; b < static_cast<std::size_t>(seen.count); ++b) {
    const auto& [segment, T] = seen.parts[b];
    for (int i = 0; i < direct_; ++i) {
      const Eigen::Matrix<double, 1, 6> row = by_twist_.row(i) * T;
      for (int j = 0; j < segment.size; ++j) block->H(first + i, start[b] + j) = row[j];
    }
  }
  block->H.block(first, first, direct_, direct_) = by_direct_.topLeftCorner(direct_, direct_);
  block->g.segment(first, direct_) = direct_g_.head(direct_);
}

}  // namespace rigproof::ml
