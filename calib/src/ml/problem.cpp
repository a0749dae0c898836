#include "ml/problem.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace rigproof::ml {
namespace {

// Cost of a corner that a trial state puts behind the camera: as bad as a very wrong one, without a slope.
constexpr double kBehindCameraSquare = 1e8;
constexpr int kMaxLocal = 21;  // camera, board, pose and three more

using LocalMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxLocal, kMaxLocal>;
using LocalVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxLocal, 1>;

// Unknowns of one pose, or globals where pose is -1.
struct Segment {
  int pose, offset, size;
};

// One block of residuals: its part of the normal equations on the few unknowns that it depends on.
struct LocalBlock {
  Group group;
  int camera;
  std::array<Segment, 4> segments;
  int segment_count;
  LocalMatrix H;
  LocalVector g;
  GroupSum sum;
  double cost;
};

double block_factor(Weighting weighting, double weight, int dimensions) {
  if (weighting == Weighting::kUnit) return 1.0;
  if (weighting == Weighting::kRobust) return weight;
  const LossMoments& moments = cauchy_moments(dimensions);
  return weight * moments.efficiency / moments.weight;
}

// Where local segments meet in an arrow system.
class Assembler {
 public:
  Assembler(ArrowSystem* system, double* cost, GroupSums* sums) : system_(system), cost_(cost), sums_(sums) {}

  void operator()(const LocalBlock& block) {
    *cost_ += block.cost;
    if (sums_ != nullptr) sum_of(*sums_, block.group, block.camera) += block.sum;
    for (int a = 0, row = 0; a < block.segment_count; row += block.segments[static_cast<std::size_t>(a)].size, ++a) {
      const Segment& sa = block.segments[static_cast<std::size_t>(a)];
      gradient(sa) += block.g.segment(row, sa.size);
      for (int b = 0, column = 0; b < block.segment_count;
           column += block.segments[static_cast<std::size_t>(b)].size, ++b) {
        const Segment& sb = block.segments[static_cast<std::size_t>(b)];
        add(sa, sb, block.H.block(row, column, sa.size, sb.size));
      }
    }
  }

 private:
  Eigen::VectorBlock<Eigen::VectorXd> gradient(const Segment& s) {
    return s.pose < 0 ? system_->global_gradient.segment(s.offset, s.size)
                      : system_->pose_gradient.segment(6 * s.pose + s.offset, s.size);
  }

  template <typename Block>
  void add(const Segment& a, const Segment& b, const Block& block) {
    if (a.pose < 0 && b.pose < 0) {
      system_->global.block(a.offset, b.offset, a.size, b.size) += block;
    } else if (a.pose >= 0 && b.pose < 0) {
      system_->pose_global.block(6 * a.pose + a.offset, b.offset, a.size, b.size) += block;
    } else if (a.pose >= 0 && a.pose == b.pose) {
      system_->diagonal[static_cast<std::size_t>(a.pose)].block(a.offset, b.offset, a.size, b.size) += block;
    } else if (a.pose >= 0 && a.pose == b.pose + 1) {
      system_->coupling[static_cast<std::size_t>(a.pose)].block(a.offset, b.offset, a.size, b.size) += block;
    }
  }

  ArrowSystem* system_;
  double* cost_;
  GroupSums* sums_;
};

// Trace of H times the covariance of the block's unknowns.
class LeverageSink {
 public:
  LeverageSink(const EliminatedSystem::PoseCovariance& poses, const Eigen::MatrixXd& globals, GroupSums* sums)
      : poses_(poses), globals_(globals), sums_(sums) {}

  void operator()(const LocalBlock& block) {
    double trace = 0.0;
    for (int a = 0, row = 0; a < block.segment_count; row += block.segments[static_cast<std::size_t>(a)].size, ++a) {
      const Segment& sa = block.segments[static_cast<std::size_t>(a)];
      for (int b = a, column = row; b < block.segment_count;
           column += block.segments[static_cast<std::size_t>(b)].size, ++b) {
        const Segment& sb = block.segments[static_cast<std::size_t>(b)];
        const double part = block.H.block(row, column, sa.size, sb.size).cwiseProduct(covariance(sa, sb)).sum();
        trace += (a == b ? 1.0 : 2.0) * part;  // both are symmetric
      }
    }
    sum_of(*sums_, block.group, block.camera).leverage += trace;
  }

 private:
  LocalMatrix covariance(const Segment& a, const Segment& b) const {
    if (a.pose < 0 && b.pose < 0) return globals_.block(a.offset, b.offset, a.size, b.size);
    if (b.pose < 0) return poses_.with_globals.block(6 * a.pose + a.offset, b.offset, a.size, b.size);
    if (a.pose < 0) return covariance(b, a).transpose();
    if (a.pose == b.pose)
      return poses_.diagonal[static_cast<std::size_t>(a.pose)].block(a.offset, b.offset, a.size, b.size);
    if (a.pose == b.pose + 1)
      return poses_.with_previous[static_cast<std::size_t>(a.pose)].block(a.offset, b.offset, a.size, b.size);
    return covariance(b, a).transpose();
  }

  const EliminatedSystem::PoseCovariance& poses_;
  const Eigen::MatrixXd& globals_;
  GroupSums* sums_;
};

// Fills H and g of a block whose Jacobian J is whitened and has the segments' columns.
template <typename Jacobian, typename Residual>
void set_normal(const Jacobian& J, const Residual& r, double factor, LocalBlock* block) {
  block->H.noalias() = factor * J.transpose() * J;
  block->g.noalias() = factor * J.transpose() * r;
}

GroupSum sum_of_residual(double square, double weight, int dimensions) {
  // Noise alone gives 45 whitened squares in three dimensions once in a billion.
  constexpr double kOutlierWeight = 1.0 / 6.0;
  GroupSum sum{square, weight * square, weight * dimensions, 0.0, dimensions};
  if (weight >= kOutlierWeight) return sum;
  sum.outlier_weighted_square = sum.weighted_square;
  sum.outlier_dimensions = dimensions;
  return sum;
}

// Corners or the board's plane of one view: accumulated on the twist of the board in the camera, then chained.
struct TwistSystem {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  Eigen::Matrix<double, 6, 3> with_extra = Eigen::Matrix<double, 6, 3>::Zero();
  Eigen::Matrix3d extra = Eigen::Matrix3d::Zero();
  Eigen::Vector3d extra_gradient = Eigen::Vector3d::Zero();

  template <typename JTwist, typename JExtra, typename Residual>
  void add(const JTwist& J, const JExtra& E, const Residual& r, double factor) {
    H.noalias() += factor * J.transpose() * J;
    g.noalias() += factor * J.transpose() * r;
    constexpr int kExtra = JExtra::ColsAtCompileTime;
    with_extra.leftCols<kExtra>().noalias() += factor * J.transpose() * E;
    extra.topLeftCorner<kExtra, kExtra>().noalias() += factor * E.transpose() * E;
    extra_gradient.head<kExtra>().noalias() += factor * E.transpose() * r;
  }

  void chain(const ViewGeometry& geometry, int extras, LocalBlock* block) const {
    Eigen::Matrix<double, 6, 18> T;
    T << geometry.twist_by_camera, geometry.twist_by_board, geometry.twist_by_pose;
    block->H.resize(18 + extras, 18 + extras);
    block->g.resize(18 + extras);
    const Eigen::Matrix<double, 18, 6> TtH = T.transpose() * H;
    block->H.topLeftCorner<18, 18>().noalias() = TtH * T;
    block->g.head<18>().noalias() = T.transpose() * g;
    if (extras == 0) return;
    block->H.topRightCorner(18, extras).noalias() = T.transpose() * with_extra.leftCols(extras);
    block->H.bottomLeftCorner(extras, 18) = block->H.topRightCorner(18, extras).transpose();
    block->H.bottomRightCorner(extras, extras) = extra.topLeftCorner(extras, extras);
    block->g.tail(extras) = extra_gradient.head(extras);
  }
};

}  // namespace

GroupSum& GroupSum::operator+=(const GroupSum& other) {
  square += other.square;
  weighted_square += other.weighted_square;
  weight += other.weight;
  leverage += other.leverage;
  dimensions += other.dimensions;
  outlier_weighted_square += other.outlier_weighted_square;
  outlier_dimensions += other.outlier_dimensions;
  return *this;
}

GroupSum GroupSum::without_outliers() const {
  constexpr int kFew = 5;  // one in five; more say that the level is wrong
  GroupSum sum = *this;
  if (kFew * outlier_dimensions > dimensions) return sum;
  sum.weighted_square -= outlier_weighted_square;
  sum.dimensions -= outlier_dimensions;
  return sum;
}

Problem::Problem(const Observations& observations, const Priors& priors, const NoiseLevels& noise_levels)
    : noise(noise_levels),
      view_left_out(observations.board_views.size(), false),
      camera_fixed(observations.cameras.size(), false),
      observations_(observations),
      layout_(Layout::of(observations, priors)),
      priors_(priors),
      ground_planes_(prepare(observations.ground_planes)),
      board_planes_(prepare(observations.board_planes)) {
  for (const BoardView& view : observations.board_views) {
    View prepared{view.stop, view.camera, {}};
    for (const CornerObservation& corner : view.corners) {
      const Eigen::Matrix2d L = corner.covariance_px2.llt().matrixL();
      const Eigen::Matrix2d whitening = L.inverse();
      if (!whitening.allFinite() || !corner.pixel.allFinite()) continue;
      prepared.corners.push_back({observations.board.corner(corner.id), corner.pixel, whitening});
    }
    views_.push_back(std::move(prepared));
  }
  for (std::size_t i = 0; i + 1 < observations.stops.size(); ++i)
    increments_.push_back(measured_increment(observations.stops[i], observations.stops[i + 1]));
}

std::vector<Problem::Plane> Problem::prepare(const std::vector<PlaneObservation>& planes) {
  std::vector<Plane> prepared;
  for (const PlaneObservation& plane : planes) {
    const Eigen::Matrix3d L = plane.covariance_per_m2.llt().matrixL();
    const Eigen::Matrix3d whitening = L.inverse();
    if (!whitening.allFinite() || !plane.inverse_depth_plane.allFinite()) continue;
    prepared.push_back({plane.stop, plane.camera, plane.inverse_depth_plane, whitening});
  }
  return prepared;
}

Camera Problem::lens(const State& state, int camera) const {
  Camera lens = observations_.cameras[static_cast<std::size_t>(camera)].camera;
  if (!layout_.with_intrinsics) return lens;
  const Eigen::Vector3d& change = state.intrinsics[static_cast<std::size_t>(camera)];
  lens.fx_px *= 1.0 + change[0];
  lens.fy_px *= 1.0 + change[0];
  lens.cx_px += change[1];
  lens.cy_px += change[2];
  return lens;
}

Eigen::Vector3d Problem::odometry_sigmas(std::size_t stop) const {
  double xy2 = noise.odometry_xy_m * noise.odometry_xy_m;
  const auto add = [&](std::size_t i) {
    const double interpolation = observations_.stops[i].interpolation_sigma_m;
    xy2 += interpolation * interpolation;
  };
  add(stop);
  if (noise.odometry_model == OdometryModel::kPerIncrement) add(stop - 1);
  const double xy = std::sqrt(xy2);
  return {xy, xy, noise.odometry_yaw_rad};
}

template <typename Sink>
void Problem::visit_blocks(const State& state, Weighting weighting, Sink&& sink) const {
  const auto at = [](const auto& values, int i) -> const auto& { return values[static_cast<std::size_t>(i)]; };
  LocalBlock block;

  for (std::size_t v = 0; v < views_.size(); ++v) {
    const View& view = views_[v];
    if (view_left_out[v]) continue;
    const Camera camera = lens(state, view.camera);
    const double whiten = 1.0 / at(noise.corner_scale, view.camera);
    const ViewGeometry geometry =
        view_geometry(at(state.T_robot_camera, view.camera), state.T_world_board, at(state.poses, view.stop));
    TwistSystem system;
    block.sum = GroupSum();
    block.cost = 0.0;
    for (const Corner& corner : view.corners) {
      CornerResidual residual;
      if (!corner_residual(camera, geometry.T_camera_board, corner.point_board, corner.pixel, &residual)) {
        block.sum.dimensions += 2;
        block.cost += loss.cost(kBehindCameraSquare);
        continue;
      }
      const Eigen::Matrix2d W = whiten * corner.whitening;
      const Eigen::Vector2d r = W * residual.value;
      const double s = r.squaredNorm(), w = loss.weight(s);
      block.cost += loss.cost(s);
      block.sum += sum_of_residual(s, w, 2);
      const Eigen::Matrix<double, 2, 6> J = W * residual.by_twist;
      const double factor = block_factor(weighting, w, 2);
      if (layout_.with_intrinsics) {
        const Eigen::Matrix<double, 2, 3> E = W * residual.by_intrinsics;
        system.add(J, E, r, factor);
      } else {
        system.H.noalias() += factor * J.transpose() * J;
        system.g.noalias() += factor * J.transpose() * r;
      }
    }
    block.group = Group::kCorners;
    block.camera = view.camera;
    block.segments = {Segment{-1, layout_.camera(view.camera), 6}, Segment{-1, layout_.board(), 6},
                      Segment{view.stop, 0, 6}, Segment{-1, layout_.intrinsics(view.camera), 3}};
    block.segment_count = layout_.with_intrinsics ? 4 : 3;
    system.chain(geometry, layout_.with_intrinsics ? 3 : 0, &block);
    sink(block);
  }

  for (const Plane& plane : board_planes_) {
    const ViewGeometry geometry =
        view_geometry(at(state.T_robot_camera, plane.camera), state.T_world_board, at(state.poses, plane.stop));
    const BoardPlaneResidual residual =
        board_plane_residual(geometry.T_camera_board, at(state.depth_bias, plane.camera), plane.measured);
    const Eigen::Matrix3d W = plane.whitening / at(noise.board_plane_scale, plane.camera);
    const Eigen::Vector3d r = W * residual.value;
    const double s = r.squaredNorm(), w = loss.weight(s);
    TwistSystem system;
    const Matrix36d J = W * residual.by_twist;
    const Eigen::Vector3d E = W * residual.by_depth_bias;
    system.add(J, E, r, block_factor(weighting, w, 3));
    block.group = Group::kBoardPlane;
    block.camera = plane.camera;
    block.segments = {Segment{-1, layout_.camera(plane.camera), 6}, Segment{-1, layout_.board(), 6},
                      Segment{plane.stop, 0, 6}, Segment{-1, layout_.depth_bias(plane.camera), 1}};
    block.segment_count = 4;
    block.cost = loss.cost(s);
    block.sum = sum_of_residual(s, w, 3);
    system.chain(geometry, 1, &block);
    sink(block);
  }

  for (const Plane& plane : ground_planes_) {
    GroundResidual residual = ground_residual(at(state.T_robot_camera, plane.camera), at(state.poses, plane.stop),
                                              at(state.depth_bias, plane.camera), plane.measured);
    const Eigen::Matrix3d W = plane.whitening / at(noise.ground_scale, plane.camera);
    if (layout_.with_ground_offsets) residual.value += at(state.ground_offset, plane.camera);
    const Eigen::Vector3d r = W * residual.value;
    const double s = r.squaredNorm(), w = loss.weight(s);
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 16> J(3, layout_.with_ground_offsets ? 16 : 13);
    J.leftCols<13>() << residual.by_camera, residual.by_pose, residual.by_depth_bias;
    if (layout_.with_ground_offsets) J.rightCols<3>().setIdentity();
    J = (W * J).eval();
    block.group = Group::kGround;
    block.camera = plane.camera;
    block.segments = {Segment{-1, layout_.camera(plane.camera), 6}, Segment{plane.stop, 0, 6},
                      Segment{-1, layout_.depth_bias(plane.camera), 1},
                      Segment{-1, layout_.ground_offset(plane.camera), 3}};
    block.segment_count = layout_.with_ground_offsets ? 4 : 3;
    block.cost = loss.cost(s);
    block.sum = sum_of_residual(s, w, 3);
    set_normal(J, r, block_factor(weighting, w, 3), &block);
    sink(block);
  }

  block.camera = 0;
  const auto emit = [&](Group group, const auto& J, const auto& r, double cost, double w, int dimensions) {
    block.group = group;
    block.cost = cost;
    block.sum = sum_of_residual(r.squaredNorm(), w, static_cast<int>(r.size()));
    set_normal(J, r, block_factor(weighting, w, dimensions), &block);
    sink(block);
  };

  const bool increments = noise.odometry_model == OdometryModel::kPerIncrement;
  for (int i = increments ? 1 : 0; i < layout_.poses; ++i) {
    const Eigen::Vector3d inverse = odometry_sigmas(static_cast<std::size_t>(i)).cwiseInverse();
    const RobotPose& to = at(state.poses, i);
    Eigen::Vector3d value;
    Eigen::Matrix<double, 3, 8> J;  // from, to, scale, yaw factor
    if (increments) {
      const IncrementResidual residual = increment_residual(at(state.poses, i - 1), to, state.odometry_scale,
                                                            state.odometry_yaw_factor, at(increments_, i - 1));
      value = inverse.cwiseProduct(residual.value);
      J << residual.by_from, residual.by_to, residual.by_scale, residual.by_yaw_factor;
      J = (inverse.asDiagonal() * J).eval();
      block.segments = {Segment{i - 1, 0, 3}, Segment{i, 0, 3}, Segment{-1, layout_.odometry_scale(), 2}, Segment{}};
      block.segment_count = 3;
    } else {
      const Stop& stop = at(observations_.stops, i);
      value << to.x_m - stop.x_m, to.y_m - stop.y_m, wrap_angle(to.yaw_rad - stop.yaw_rad);
      value = inverse.cwiseProduct(value).eval();
      block.segments = {Segment{i, 0, 3}, Segment{}, Segment{}, Segment{}};
      block.segment_count = 1;
    }
    const double s = value.squaredNorm(), w = loss.weight(s);
    if (increments) {
      emit(Group::kOdometryXy, J.topRows<2>(), value.head<2>(), loss.cost(s), w, 3);
      emit(Group::kOdometryYaw, J.bottomRows<1>(), value.tail<1>(), 0.0, w, 3);
    } else {
      const Eigen::Matrix3d D = inverse.asDiagonal();
      emit(Group::kOdometryXy, D.topRows<2>(), value.head<2>(), loss.cost(s), w, 3);
      emit(Group::kOdometryYaw, D.bottomRows<1>(), value.tail<1>(), 0.0, w, 3);
    }
  }

  const Eigen::Vector3d slack(1.0 / noise.suspension_height_m, 1.0 / noise.suspension_tilt_rad,
                              1.0 / noise.suspension_tilt_rad);
  const Eigen::Matrix3d D = slack.asDiagonal();
  for (int i = 0; i < layout_.poses; ++i) {
    const RobotPose& pose = at(state.poses, i);
    const Eigen::Vector3d r = slack.cwiseProduct(Eigen::Vector3d(pose.height_m, pose.roll_rad, pose.pitch_rad));
    const double s = r.squaredNorm(), w = loss.weight(s);
    block.segments = {Segment{i, 3, 3}, Segment{}, Segment{}, Segment{}};
    block.segment_count = 1;
    emit(Group::kSuspensionHeight, D.topRows<1>(), r.head<1>(), loss.cost(s), w, 3);
    emit(Group::kSuspensionTilt, D.bottomRows<2>(), r.tail<2>(), 0.0, w, 3);
  }
}

void Problem::add_priors(const State& state, ArrowSystem* system, double* cost) const {
  const auto add = [&](int unknown, double value, double sigma) {
    if (sigma <= 0.0) return;
    const double information = 1.0 / (sigma * sigma);
    system->global(unknown, unknown) += information;
    system->global_gradient[unknown] += information * value;
    *cost += information * value * value;
  };
  if (noise.odometry_model == OdometryModel::kPerIncrement) {
    add(layout_.odometry_scale(), state.odometry_scale - 1.0, priors_.odometry_scale);
    add(layout_.odometry_yaw_factor(), state.odometry_yaw_factor - 1.0, priors_.odometry_yaw_factor);
  }
  for (int c = 0; c < layout_.cameras; ++c) {
    const std::size_t i = static_cast<std::size_t>(c);
    add(layout_.depth_bias(c), state.depth_bias[i], priors_.depth_bias[i]);
    if (has_ground_offset(c)) {
      const Eigen::Matrix3d information = priors_.ground_offset[i].inverse();
      const Eigen::Vector3d g = information * state.ground_offset[i];
      system->global.block<3, 3>(layout_.ground_offset(c), layout_.ground_offset(c)) += information;
      system->global_gradient.segment<3>(layout_.ground_offset(c)) += g;
      *cost += g.dot(state.ground_offset[i]);
    }
    if (!layout_.with_intrinsics) continue;
    add(layout_.intrinsics(c), state.intrinsics[i][0], priors_.focal_relative);
    add(layout_.intrinsics(c) + 1, state.intrinsics[i][1], priors_.principal_point_px);
    add(layout_.intrinsics(c) + 2, state.intrinsics[i][2], priors_.principal_point_px);
  }
}

void Problem::fix_unknowns(ArrowSystem* system) const {
  const bool increments = noise.odometry_model == OdometryModel::kPerIncrement;
  // Increments say nothing about where the world is: the first pose does.
  if (increments && layout_.poses > 0)
    for (int unknown = 0; unknown < 3; ++unknown) system->fix_pose_unknown(0, unknown);
  if (!increments || priors_.odometry_scale <= 0.0) system->fix_global_unknown(layout_.odometry_scale());
  if (!increments || priors_.odometry_yaw_factor <= 0.0) system->fix_global_unknown(layout_.odometry_yaw_factor());
  for (int c = 0; c < layout_.cameras; ++c) {
    if (camera_fixed[static_cast<std::size_t>(c)])
      for (int unknown = 0; unknown < 6; ++unknown) system->fix_global_unknown(layout_.camera(c) + unknown);
    if (priors_.depth_bias[static_cast<std::size_t>(c)] <= 0.0) system->fix_global_unknown(layout_.depth_bias(c));
    if (layout_.with_ground_offsets && !has_ground_offset(c))
      for (int unknown = 0; unknown < 3; ++unknown) system->fix_global_unknown(layout_.ground_offset(c) + unknown);
    if (!layout_.with_intrinsics) continue;
    if (priors_.focal_relative <= 0.0) system->fix_global_unknown(layout_.intrinsics(c));
    if (priors_.principal_point_px > 0.0) continue;
    system->fix_global_unknown(layout_.intrinsics(c) + 1);
    system->fix_global_unknown(layout_.intrinsics(c) + 2);
  }
}

ArrowSystem Problem::linearise(const State& state, Weighting weighting, double* cost, GroupSums* sums) const {
  ArrowSystem system(layout_.poses, layout_.globals());
  double total = 0.0;
  if (sums != nullptr) *sums = empty_sums();
  visit_blocks(state, weighting, Assembler(&system, &total, sums));
  add_priors(state, &system, &total);
  fix_unknowns(&system);
  if (cost != nullptr) *cost = total;
  return system;
}

void Problem::add_leverage(const State& state, const EliminatedSystem::PoseCovariance& poses,
                           const Eigen::MatrixXd& globals, GroupSums* sums) const {
  visit_blocks(state, Weighting::kInformation, LeverageSink(poses, globals, sums));
}

std::optional<GroupSums> Problem::sums_with_leverage(const State& state) const {
  GroupSums sums;
  const ArrowSystem system = linearise(state, Weighting::kInformation, nullptr, &sums);
  const std::optional<EliminatedSystem> eliminated = EliminatedSystem::eliminate(system, 0.0);
  if (!eliminated) return std::nullopt;
  const Eigen::MatrixXd covariance = invert_information(eliminated->schur()).covariance;
  add_leverage(state, eliminated->pose_covariance(covariance), covariance, &sums);
  return sums;
}

double Problem::log_normalisation() const {
  double sum = 0.0;
  const bool increments = noise.odometry_model == OdometryModel::kPerIncrement;
  for (std::size_t i = increments ? 1 : 0; i < observations_.stops.size(); ++i)
    sum += 2.0 * odometry_sigmas(i).array().log().sum();
  sum += 2.0 * layout_.poses * (std::log(noise.suspension_height_m) + 2.0 * std::log(noise.suspension_tilt_rad));
  for (std::size_t v = 0; v < views_.size(); ++v)
    if (!view_left_out[v])
      sum += 4.0 * static_cast<double>(views_[v].corners.size()) *
             std::log(noise.corner_scale[static_cast<std::size_t>(views_[v].camera)]);
  for (const Plane& plane : ground_planes_)
    sum += 6.0 * std::log(noise.ground_scale[static_cast<std::size_t>(plane.camera)]);
  for (const Plane& plane : board_planes_)
    sum += 6.0 * std::log(noise.board_plane_scale[static_cast<std::size_t>(plane.camera)]);
  return sum;
}

Problem::ViewFit Problem::view_fit(const State& state, std::size_t index) const {
  const View& view = views_[index];
  const Camera camera = lens(state, view.camera);
  const std::size_t c = static_cast<std::size_t>(view.camera);
  const ViewGeometry geometry =
      view_geometry(state.T_robot_camera[c], state.T_world_board, state.poses[static_cast<std::size_t>(view.stop)]);
  ViewFit fit;
  if (view.corners.empty()) return fit;
  double square = 0.0, weight = 0.0;
  for (const Corner& corner : view.corners) {
    CornerResidual residual;
    if (!corner_residual(camera, geometry.T_camera_board, corner.point_board, corner.pixel, &residual)) continue;
    square += residual.value.squaredNorm();
    weight += loss.weight((corner.whitening * residual.value / noise.corner_scale[c]).squaredNorm());
  }
  const double count = static_cast<double>(view.corners.size());
  fit.rms_px = std::sqrt(square / count);
  fit.mean_weight = weight / count;
  return fit;
}

GroupSums Problem::empty_sums() const {
  GroupSums sums;
  for (std::vector<GroupSum>& group : sums)
    group.assign(static_cast<std::size_t>(std::max(1, layout_.cameras)), GroupSum());
  return sums;
}

}  // namespace rigproof::ml
