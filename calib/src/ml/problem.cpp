#include "ml/problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "methods/depth_bias.h"
#include "ml/lens_change.h"

namespace rigproof::ml {
namespace {

// Cost of a corner that a trial state puts behind the camera: as bad as a very wrong one, without a slope.
constexpr double kBehindCameraSquare = 1e8;

// Unknowns of one pose, or globals where pose is -1.
struct Segment {
  int pose, offset;
};

// One block of residuals: its part of the normal equations on the few unknowns that it depends on, in segments of the
// given sizes. Of H the blocks on and below the diagonal count.
template <int... kSizes>
struct LocalBlock {
  static constexpr std::size_t kCount = sizeof...(kSizes);
  static constexpr int kUnknowns = (kSizes + ...);
  static constexpr std::array<int, kCount> kSize = {kSizes...};
  static constexpr int start(std::size_t segment) {
    int sum = 0;
    for (std::size_t i = 0; i < segment; ++i) sum += kSize[i];
    return sum;
  }

  Group group;
  int camera;
  std::array<Segment, kCount> segments;
  Eigen::Matrix<double, kUnknowns, kUnknowns> H;
  Eigen::Matrix<double, kUnknowns, 1> g;
  GroupSum sum;
  double cost = 0.0;

  // Fills H and g from a whitened Jacobian with the segments' columns.
  template <typename Jacobian, typename Residual>
  void set_normal(const Jacobian& J, const Residual& r, double factor) {
    const auto weighted = (factor * J.transpose()).eval();
    H.noalias() = weighted.lazyProduct(J);
    g.noalias() = weighted.lazyProduct(r);
  }
};

template <typename Visit, std::size_t... kIndices>
void for_each_index(const Visit& visit, std::index_sequence<kIndices...>) {
  (visit(std::integral_constant<std::size_t, kIndices>()), ...);
}

// visit(a, b) for every block of H on and below the diagonal, with the segments' numbers as constants.
template <typename Block, typename Visit>
void for_each_pair(const Visit& visit) {
  for_each_index(
      [&visit](auto a) {
        for_each_index([&visit, a](auto b) { visit(a, b); }, std::make_index_sequence<decltype(a)::value + 1>());
      },
      std::make_index_sequence<Block::kCount>());
}

// By how much the image of a camera is later than the stop, by the stamps.
double seconds_after_stop(const Observations& observations, int stop, int camera) {
  const Stop& at = observations.stops[static_cast<std::size_t>(stop)];
  if (at.velocity.isZero(0.0)) return 0.0;
  const std::vector<BoardView>& views = observations.board_views;
  const auto view = std::find_if(views.begin(), views.end(), [stop, camera](const BoardView& candidate) {
    return candidate.stop == stop && candidate.camera == camera;
  });
  return view == views.end() ? 0.0 : view->stamp_s - at.stamp_s;
}

double block_factor(Weighting weighting, double weight, const LossMoments& moments) {
  if (weighting == Weighting::kUnit) return 1.0;
  if (weighting == Weighting::kRobust) return weight;
  if (weighting == Weighting::kSlope) return weight * moments.weighted_square / moments.weight;
  return weight * moments.efficiency / moments.weight;
}

// A block without redundancy meets its residual whatever its weight.
Weighting without_redundancy(Weighting weighting) {
  return weighting == Weighting::kSlope ? Weighting::kRobust : weighting;
}

// Where local segments meet in an arrow system. Of the globals' block only the part below the diagonal is filled.
class Assembler {
 public:
  Assembler(ArrowSystem* system, double* cost, GroupSums* sums) : system_(system), cost_(cost), sums_(sums) {}

  template <typename Block>
  void operator()(const Block& block) {
    *cost_ += block.cost;
    if (sums_ != nullptr) sum_of(*sums_, block.group, block.camera) += block.sum;
    for_each_index(
        [&](auto a) {
          constexpr std::size_t A = decltype(a)::value;
          gradient<Block::kSize[A]>(block.segments[A]) += block.g.template segment<Block::kSize[A]>(Block::start(A));
        },
        std::make_index_sequence<Block::kCount>());
    for_each_pair<Block>([&](auto a, auto b) {
      constexpr std::size_t A = decltype(a)::value, B = decltype(b)::value;
      add<Block::kSize[A], Block::kSize[B]>(
          block.segments[A], block.segments[B],
          block.H.template block<Block::kSize[A], Block::kSize[B]>(Block::start(A), Block::start(B)));
    });
  }

 private:
  template <int kSize>
  auto gradient(const Segment& s) {
    return s.pose < 0 ? system_->global_gradient.segment<kSize>(s.offset)
                      : system_->pose_gradient.segment<kSize>(6 * s.pose + s.offset);
  }

  template <int kRows, int kColumns, typename Block>
  void add(const Segment& a, const Segment& b, const Block& block) {
    if (a.pose < 0 && b.pose < 0)
      system_->global.block<kRows, kColumns>(a.offset, b.offset) += block;
    else if (b.pose < 0)
      system_->pose_global.block<kRows, kColumns>(6 * a.pose + a.offset, b.offset) += block;
    else if (a.pose < 0)
      system_->pose_global.block<kColumns, kRows>(6 * b.pose + b.offset, a.offset) += block.transpose();
    else if (a.pose == b.pose)
      system_->diagonal[static_cast<std::size_t>(a.pose)].block<kRows, kColumns>(a.offset, b.offset) += block;
    else
      system_->coupling[static_cast<std::size_t>(a.pose)].block<kRows, kColumns>(a.offset, b.offset) += block;
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

  template <typename Block>
  void operator()(const Block& block) {
    double trace = 0.0;
    for_each_pair<Block>([&](auto a, auto b) {
      constexpr std::size_t A = decltype(a)::value, B = decltype(b)::value;
      const double part = product<Block::kSize[A], Block::kSize[B]>(
          block.segments[A], block.segments[B],
          block.H.template block<Block::kSize[A], Block::kSize[B]>(Block::start(A), Block::start(B)));
      trace += (A == B ? 1.0 : 2.0) * part;  // both are symmetric
    });
    sum_of(*sums_, block.group, block.camera).leverage += trace;
  }

 private:
  // Sum of the products of H's elements with the covariance's.
  template <int kRows, int kColumns, typename Block>
  double product(const Segment& a, const Segment& b, const Block& H) const {
    if (a.pose < 0 && b.pose < 0) return H.cwiseProduct(globals_.block<kRows, kColumns>(a.offset, b.offset)).sum();
    if (b.pose < 0)
      return H.cwiseProduct(poses_.with_globals.block<kRows, kColumns>(6 * a.pose + a.offset, b.offset)).sum();
    if (a.pose < 0)
      return H.transpose()
          .cwiseProduct(poses_.with_globals.block<kColumns, kRows>(6 * b.pose + b.offset, a.offset))
          .sum();
    const std::vector<Matrix6d>& blocks = a.pose == b.pose ? poses_.diagonal : poses_.with_previous;
    return H.cwiseProduct(blocks[static_cast<std::size_t>(a.pose)].block<kRows, kColumns>(a.offset, b.offset)).sum();
  }

  const EliminatedSystem::PoseCovariance& poses_;
  const Eigen::MatrixXd& globals_;
  GroupSums* sums_;
};

// Noise alone gives 45 whitened squares in three dimensions once in a billion.
constexpr double kOutlierWeight = 1.0 / 6.0;

void add_residual(double square, double weight, double dimensions, GroupSum* sum) {
  const double weighted = weight * square;
  sum->square += square;
  sum->weighted_square += weighted;
  sum->weight += weight * dimensions;
  sum->dimensions += dimensions;
  if (weight >= kOutlierWeight) return;
  sum->outlier_weighted_square += weighted;
  sum->outlier_dimensions += dimensions;
}

GroupSum sum_of_residual(double square, double weight, double dimensions) {
  GroupSum sum;
  add_residual(square, weight, dimensions, &sum);
  return sum;
}

// Sum of the loss of many residuals: one logarithm of their product, kept as what it exceeds one by.
class CostSum {
 public:
  explicit CostSum(double c2) : c2_(c2) {}
  void add(double square) {
    constexpr double kLargest = 1e200;
    const double x = square / c2_;
    excess_ += x + excess_ * x;
    if (excess_ < kLargest) return;
    sum_ += std::log1p(excess_);
    excess_ = 0.0;
  }
  double cost() const { return c2_ * (sum_ + std::log1p(excess_)); }

 private:
  double c2_, excess_ = 0.0, sum_ = 0.0;
};

// Corners or the board's plane of one view: accumulated on the twist of the board in the camera, then chained to
// camera, board, pose and kExtra unknowns more.
template <int kExtra>
struct TwistSystem {
  static constexpr int kUnknowns = 6 + kExtra;
  Eigen::Matrix<double, kUnknowns, kUnknowns> H = Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
  Eigen::Matrix<double, kUnknowns, 1> g = Eigen::Matrix<double, kUnknowns, 1>::Zero();

  // J by twist and extras, a row for each residual.
  template <typename Jacobian, typename Residual>
  void add(const Jacobian& J, const Residual& r, double factor) {
    const auto weighted = (factor * J.transpose()).eval();
    H.noalias() += weighted.lazyProduct(J);
    g.noalias() += weighted.lazyProduct(r);
  }

  template <typename Block>
  void chain(const ViewGeometry& geometry, Block* block) const {
    const auto twist = H.template topLeftCorner<6, 6>();
    const std::array<const Matrix6d*, 3> by = {&geometry.twist_by_camera, &geometry.twist_by_board,
                                               &geometry.twist_by_pose};
    std::array<Matrix6d, 3> H_by;
    for (std::size_t b = 0; b < 3; ++b) H_by[b].noalias() = twist * *by[b];
    for (int a = 0; a < 3; ++a) {
      const Matrix6d& T = *by[static_cast<std::size_t>(a)];
      for (int b = 0; b <= a; ++b)
        block->H.template block<6, 6>(6 * a, 6 * b).noalias() = T.transpose() * H_by[static_cast<std::size_t>(b)];
      block->g.template segment<6>(6 * a).noalias() = T.transpose() * g.template head<6>();
      if constexpr (kExtra > 0)
        block->H.template block<kExtra, 6>(18, 6 * a).noalias() = H.template block<kExtra, 6>(6, 0) * T;
    }
    if constexpr (kExtra > 0) {
      block->H.template block<kExtra, kExtra>(18, 18) = H.template block<kExtra, kExtra>(6, 6);
      block->g.template tail<kExtra>() = g.template tail<kExtra>();
    }
  }
};

template <int... kSizes, typename... Segments>
LocalBlock<kSizes...> make_block(Group group, int camera, Segments... segments) {
  LocalBlock<kSizes...> block;
  block.group = group;
  block.camera = camera;
  block.segments = {segments...};
  return block;
}

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
  constexpr double kFew = 5.0;  // one in five; more say that the level is wrong
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
      ground_planes_(prepare(observations.ground_planes, {})),
      board_planes_(prepare(observations.board_planes, board_plane_biases(observations))) {
  for (const BoardView& view : observations.board_views) {
    View prepared{view.stop, view.camera, seconds_after_stop(observations, view.stop, view.camera), {}};
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
  for (std::size_t i = 0; noise_levels.along_way && i + 1 < observations.stops.size(); ++i)
    ways_.emplace_back(observations.stops[i], observations.stops[i + 1]);
}

std::vector<Problem::Plane> Problem::prepare(const std::vector<PlaneObservation>& planes,
                                             const std::vector<Eigen::Matrix3d>& biases) const {
  std::vector<Plane> prepared;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const PlaneObservation& plane = planes[i];
    const Eigen::Matrix3d covariance = biases.empty() ? plane.covariance_per_m2 : plane.covariance_per_m2 + biases[i];
    const Eigen::Matrix3d L = covariance.llt().matrixL();
    const Eigen::Matrix3d whitening = L.inverse();
    if (!whitening.allFinite() || !plane.inverse_depth_plane.allFinite()) continue;
    prepared.push_back({plane.stop, plane.camera, seconds_after_stop(observations_, plane.stop, plane.camera),
                        plane.inverse_depth_plane, whitening,
                        is_registered(plane, observations_.cameras[static_cast<std::size_t>(plane.camera)])});
  }
  return prepared;
}

Camera Problem::lens(const State& state, int camera) const {
  const Camera& stated = observations_.cameras[static_cast<std::size_t>(camera)].camera;
  return layout_.with_intrinsics ? changed_lens(stated, state.intrinsics[static_cast<std::size_t>(camera)]) : stated;
}

Problem::MeasuredPlane Problem::measured_plane(const State& state, const Plane& plane) const {
  MeasuredPlane result;
  result.value = plane.measured;
  if (!layout_.with_intrinsics || !plane.registered) return result;
  result.by_intrinsics =
      plane_by_lens(plane.measured, observations_.cameras[static_cast<std::size_t>(plane.camera)].camera);
  result.value += result.by_intrinsics * state.intrinsics[static_cast<std::size_t>(plane.camera)];
  return result;
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

double Problem::log_odometry_variance(std::size_t stop) const {
  if (!noise.along_way) return 2.0 * odometry_sigmas(stop).array().log().sum();
  return 2.0 * way_noise(ways_[stop - 1], noise, observations_.stops[stop - 1], observations_.stops[stop])
                   .whitening.diagonal()
                   .array()
                   .inverse()
                   .log()
                   .sum();
}

Problem::ImageTime Problem::time_of(double after_stop_s) const {
  if (layout_.with_clock_offsets) return ImageTime::kByClock;
  return after_stop_s == 0.0 ? ImageTime::kOfStop : ImageTime::kByStamp;
}

PoseAtImage Problem::pose_at_image(const State& state, int stop, int camera, double after_stop_s) const {
  const std::size_t i = static_cast<std::size_t>(stop);
  if (time_of(after_stop_s) == ImageTime::kOfStop) return {state.poses[i]};
  const double late_s = state.clock_offset_s[static_cast<std::size_t>(camera)] - after_stop_s;
  return ml::pose_at_image(state.poses[i], observations_.stops[i].velocity, late_s, state.turn_lag_s,
                           state.odometry_scale, state.odometry_yaw_factor);
}

template <bool kLens, Problem::ImageTime kTime, typename Sink>
void Problem::visit_view(const State& state, Weighting weighting, const View& view, Sink& sink) const {
  const std::size_t c = static_cast<std::size_t>(view.camera);
  const Camera camera = lens(state, view.camera);
  const double whiten = 1.0 / noise.corner_scale[c];
  const LossMoments& moments = cauchy_moments(2);
  const PoseAtImage at_image = pose_at_image(state, view.stop, view.camera, view.after_stop_s);
  ViewGeometry geometry = view_geometry(state.T_robot_camera[c], state.T_world_board, at_image.pose);
  constexpr bool kMoved = kTime != ImageTime::kOfStop, kClock = kTime == ImageTime::kByClock;
  ClockTwist clock;
  if constexpr (kMoved) clock = chain_to_stop(at_image, &geometry);
  const Eigen::Matrix3d R_camera_board = geometry.T_camera_board.rotation_matrix();
  // Of globals the blocks below the diagonal are filled: in the order of their places.
  constexpr int kFactors = kMoved ? 2 : 0, kExtra = kFactors + (kLens ? 3 : 0) + (kClock ? 2 : 0);
  auto block = [&] {
    const Segment camera_part{-1, layout_.camera(view.camera)}, board{-1, layout_.board()}, pose{view.stop, 0},
        factors{-1, layout_.odometry_scale()}, lens{-1, layout_.intrinsics(view.camera)},
        offset{-1, layout_.clock_offset(view.camera)}, lag{-1, layout_.turn_lag()};
    constexpr Group kGroup = Group::kCorners;
    if constexpr (kLens && kClock)
      return make_block<6, 6, 6, 2, 3, 1, 1>(kGroup, view.camera, camera_part, board, pose, factors, lens, offset, lag);
    else if constexpr (kClock)
      return make_block<6, 6, 6, 2, 1, 1>(kGroup, view.camera, camera_part, board, pose, factors, offset, lag);
    else if constexpr (kLens && kMoved)
      return make_block<6, 6, 6, 2, 3>(kGroup, view.camera, camera_part, board, pose, factors, lens);
    else if constexpr (kMoved)
      return make_block<6, 6, 6, 2>(kGroup, view.camera, camera_part, board, pose, factors);
    else if constexpr (kLens)
      return make_block<6, 6, 6, 3>(kGroup, view.camera, camera_part, board, pose, lens);
    else
      return make_block<6, 6, 6>(kGroup, view.camera, camera_part, board, pose);
  }();
  TwistSystem<kExtra> system;
  CostSum cost(loss.c2);
  for (const Corner& corner : view.corners) {
    const Eigen::Vector3d q = R_camera_board * corner.point_board + geometry.T_camera_board.translation;
    CornerResidual residual;
    if (!corner_residual(camera, q, corner.pixel, &residual)) {
      block.sum.dimensions += 2;
      cost.add(kBehindCameraSquare);
      continue;
    }
    const Eigen::Matrix2d W = whiten * corner.whitening;
    const Eigen::Vector2d r = W * residual.value;
    const double s = r.squaredNorm(), w = loss.weight(s);
    cost.add(s);
    add_residual(s, w, 2, &block.sum);
    RowJacobian<2, 6 + kExtra> J;
    J.template leftCols<6>() = W * residual.by_twist;
    if constexpr (kLens) {
      residual.by_intrinsics.col(0) /= 1.0 + state.intrinsics[c][0];  // of the stated focal length
      J.template middleCols<3>(6 + kFactors) = W * residual.by_intrinsics;
    }
    if constexpr (kMoved) J.template middleCols<2>(6) = J.template leftCols<6>() * clock.by_factors;
    if constexpr (kClock) J.template rightCols<2>() = J.template leftCols<6>() * clock.by_times;
    system.add(J, r, block_factor(weighting, w, moments));
  }
  block.cost = cost.cost();
  system.chain(geometry, &block);
  sink(block);
}

template <bool kLens, Problem::ImageTime kTime, typename Sink>
void Problem::visit_board_plane(const State& state, Weighting weighting, const Plane& plane, Sink& sink) const {
  constexpr bool kClock = kTime == ImageTime::kByClock, kMoved = kTime != ImageTime::kOfStop;
  const std::size_t c = static_cast<std::size_t>(plane.camera);
  const PoseAtImage at_image = pose_at_image(state, plane.stop, plane.camera, plane.after_stop_s);
  ViewGeometry geometry = view_geometry(state.T_robot_camera[c], state.T_world_board, at_image.pose);
  const MeasuredPlane measured = measured_plane(state, plane);
  const BoardPlaneResidual residual =
      board_plane_residual(geometry.T_camera_board, state.depth_bias[c], measured.value);
  const Eigen::Matrix3d W = plane.whitening / noise.board_plane_scale[c];
  const Eigen::Vector3d r = W * residual.value;
  const double s = r.squaredNorm(), w = loss.weight(s);
  ClockTwist clock;
  if constexpr (kMoved) clock = chain_to_stop(at_image, &geometry);
  constexpr int kFactors = kMoved ? 2 : 0, kExtra = kFactors + 1 + (kLens ? 3 : 0) + (kClock ? 2 : 0);
  auto block = [&] {
    const Segment camera{-1, layout_.camera(plane.camera)}, board{-1, layout_.board()}, pose{plane.stop, 0},
        factors{-1, layout_.odometry_scale()}, bias{-1, layout_.depth_bias(plane.camera)},
        lens{-1, layout_.intrinsics(plane.camera)}, offset{-1, layout_.clock_offset(plane.camera)},
        lag{-1, layout_.turn_lag()};
    constexpr Group kGroup = Group::kBoardPlane;
    if constexpr (kLens && kClock)
      return make_block<6, 6, 6, 2, 1, 3, 1, 1>(kGroup, plane.camera, camera, board, pose, factors, bias, lens, offset,
                                                lag);
    else if constexpr (kClock)
      return make_block<6, 6, 6, 2, 1, 1, 1>(kGroup, plane.camera, camera, board, pose, factors, bias, offset, lag);
    else if constexpr (kLens && kMoved)
      return make_block<6, 6, 6, 2, 1, 3>(kGroup, plane.camera, camera, board, pose, factors, bias, lens);
    else if constexpr (kMoved)
      return make_block<6, 6, 6, 2, 1>(kGroup, plane.camera, camera, board, pose, factors, bias);
    else if constexpr (kLens)
      return make_block<6, 6, 6, 1, 3>(kGroup, plane.camera, camera, board, pose, bias, lens);
    else
      return make_block<6, 6, 6, 1>(kGroup, plane.camera, camera, board, pose, bias);
  }();
  RowJacobian<3, 6 + kExtra> J;
  J.template leftCols<6>() = residual.by_twist;
  J.col(6 + kFactors) = residual.by_depth_bias;
  if constexpr (kMoved) J.template middleCols<2>(6) = residual.by_twist * clock.by_factors;
  if constexpr (kLens) J.template middleCols<3>(7 + kFactors) = -measured.by_intrinsics;
  if constexpr (kClock) J.template rightCols<2>() = residual.by_twist * clock.by_times;
  TwistSystem<kExtra> system;
  system.add((W * J).eval(), r, block_factor(weighting, w, cauchy_moments(3)));
  block.cost = loss.cost(s);
  block.sum = sum_of_residual(s, w, 3);
  system.chain(geometry, &block);
  sink(block);
}

template <bool kLens, typename Sink>
void Problem::visit_board_plane_at_its_time(const State& state, Weighting weighting, const Plane& plane,
                                            Sink& sink) const {
  const ImageTime time = time_of(plane.after_stop_s);
  if (time == ImageTime::kByClock)
    visit_board_plane<kLens, ImageTime::kByClock>(state, weighting, plane, sink);
  else if (time == ImageTime::kByStamp)
    visit_board_plane<kLens, ImageTime::kByStamp>(state, weighting, plane, sink);
  else
    visit_board_plane<kLens, ImageTime::kOfStop>(state, weighting, plane, sink);
}

template <typename Sink>
void Problem::visit_ground_plane(const State& state, Weighting weighting, const Plane& plane, Sink& sink) const {
  const std::size_t c = static_cast<std::size_t>(plane.camera);
  const MeasuredPlane measured = measured_plane(state, plane);
  GroundResidual residual = ground_residual(state.T_robot_camera[c], state.poses[static_cast<std::size_t>(plane.stop)],
                                            state.depth_bias[c], measured.value);
  if (layout_.with_ground_offsets) residual.value += state.ground_offset[c];
  const Eigen::Matrix3d W = plane.whitening / noise.ground_scale[c];
  const Eigen::Vector3d r = W * residual.value;
  const double s = r.squaredNorm(), w = loss.weight(s);
  const double factor = block_factor(weighting, w, cauchy_moments(3));
  RowJacobian<3, 13> J;
  J << residual.by_camera, residual.by_pose, residual.by_depth_bias;
  const auto finish = [&](auto block, const auto& jacobian) {
    block.cost = loss.cost(s);
    block.sum = sum_of_residual(s, w, 3);
    block.set_normal((W * jacobian).eval(), r, factor);
    sink(block);
  };
  const Segment camera{-1, layout_.camera(plane.camera)}, pose{plane.stop, 0},
      bias{-1, layout_.depth_bias(plane.camera)}, lens{-1, layout_.intrinsics(plane.camera)},
      offset{-1, layout_.ground_offset(plane.camera)};
  const Eigen::Matrix3d by_offset = Eigen::Matrix3d::Identity();
  if (layout_.with_intrinsics && layout_.with_ground_offsets) {
    RowJacobian<3, 19> all;
    all << J, -measured.by_intrinsics, by_offset;
    finish(make_block<6, 6, 1, 3, 3>(Group::kGround, plane.camera, camera, pose, bias, lens, offset), all);
  } else if (layout_.with_intrinsics) {
    RowJacobian<3, 16> with_lens;
    with_lens << J, -measured.by_intrinsics;
    finish(make_block<6, 6, 1, 3>(Group::kGround, plane.camera, camera, pose, bias, lens), with_lens);
  } else if (layout_.with_ground_offsets) {
    RowJacobian<3, 16> with_offset;
    with_offset << J, by_offset;
    finish(make_block<6, 6, 1, 3>(Group::kGround, plane.camera, camera, pose, bias, offset), with_offset);
  } else {
    finish(make_block<6, 6, 1>(Group::kGround, plane.camera, camera, pose, bias), J);
  }
}

template <typename Sink>
void Problem::visit_increment(const State& state, Weighting weighting, int to, Sink& sink) const {
  const std::size_t i = static_cast<std::size_t>(to);
  const Eigen::Vector3d inverse = odometry_sigmas(i).cwiseInverse();
  const IncrementResidual residual = increment_residual(state.poses[i - 1], state.poses[i], state.odometry_scale,
                                                        state.odometry_yaw_factor, increments_[i - 1]);
  const Eigen::Vector3d r = inverse.cwiseProduct(residual.value);
  const double s = r.squaredNorm(), w = loss.weight(s);
  RowJacobian<3, 8> J;
  J << residual.by_from, residual.by_to, residual.by_scale, residual.by_yaw_factor;
  J = (inverse.asDiagonal() * J).eval();
  const double factor = block_factor(without_redundancy(weighting), w, cauchy_moments(3));
  auto block = make_block<3, 3, 2>(Group::kOdometryXy, 0, Segment{to - 1, 0}, Segment{to, 0},
                                   Segment{-1, layout_.odometry_scale()});
  block.cost = loss.cost(s);
  block.sum = sum_of_residual(r.head<2>().squaredNorm(), w, 2);
  block.set_normal(J.topRows<2>(), r.head<2>(), factor);
  sink(block);
  block.group = Group::kOdometryYaw;
  block.cost = 0.0;
  block.sum = sum_of_residual(r.tail<1>().squaredNorm(), w, 1);
  block.set_normal(J.bottomRows<1>(), r.tail<1>(), factor);
  sink(block);
}

// Translation and turning share the residuals: a group's part is what its noise is of each residual's variance.
template <typename Sink>
void Problem::visit_way(const State& state, Weighting weighting, int to, Sink& sink) const {
  const std::size_t i = static_cast<std::size_t>(to);
  const OdometryWay& way = ways_[i - 1];
  const WayNoise shape = way_noise(way, noise, observations_.stops[i - 1], observations_.stops[i]);
  const IncrementResidual residual =
      way_residual(state.poses[i - 1], state.poses[i], state.odometry_scale, state.odometry_yaw_factor, way);
  const Eigen::Vector3d r = shape.whitening * residual.value;
  const double s = r.squaredNorm(), w = loss.weight(s);
  RowJacobian<3, 8> J;
  J << residual.by_from, residual.by_to, residual.by_scale, residual.by_yaw_factor;
  J = (shape.whitening * J).eval();
  const double factor = block_factor(without_redundancy(weighting), w, cauchy_moments(3));
  auto block = make_block<3, 3, 2>(Group::kOdometryXy, 0, Segment{to - 1, 0}, Segment{to, 0},
                                   Segment{-1, layout_.odometry_scale()});
  for (const Group group : {Group::kOdometryXy, Group::kOdometryYaw}) {
    const Eigen::Matrix3d share =
        group == Group::kOdometryYaw ? shape.turning : Eigen::Matrix3d(Eigen::Matrix3d::Identity() - shape.turning);
    const RowJacobian<3, 8> shared = share * J;
    block.group = group;
    block.cost = group == Group::kOdometryXy ? loss.cost(s) : 0.0;
    block.sum = sum_of_residual(r.dot(share * r), w, share.trace());
    block.H = factor * J.transpose() * shared;
    block.g = factor * shared.transpose() * r;
    sink(block);
  }
}

// Three residuals that share a loss, each on one unknown of the pose: absolute odometry or the suspension's slack.
template <typename Sink>
void Problem::visit_diagonal(const Eigen::Vector3d& value, const Eigen::Vector3d& inverse_sigmas, Weighting weighting,
                             const PosePart& part, Sink& sink) const {
  const Eigen::Vector3d r = inverse_sigmas.cwiseProduct(value);
  const double s = r.squaredNorm(), w = loss.weight(s);
  const double factor = block_factor(without_redundancy(weighting), w, cauchy_moments(3));
  auto block = make_block<3>(part.first, 0, Segment{part.pose, part.offset});
  for (const bool first : {true, false}) {
    Eigen::Vector3d mine;  // 1 for the residuals of this group
    for (int i = 0; i < 3; ++i) mine[i] = (i < part.split) == first ? 1.0 : 0.0;
    const Eigen::Vector3d scale = mine.cwiseProduct(inverse_sigmas);
    block.group = first ? part.first : part.second;
    block.cost = first ? loss.cost(s) : 0.0;
    block.sum = sum_of_residual(mine.cwiseProduct(r).squaredNorm(), w, first ? part.split : 3 - part.split);
    block.H = (factor * scale.cwiseAbs2()).asDiagonal();
    block.g = factor * scale.cwiseProduct(r);
    sink(block);
  }
}

template <typename Sink>
void Problem::visit_poses(const State& state, Weighting weighting, Sink& sink) const {
  const bool increments = noise.odometry_model == OdometryModel::kPerIncrement;
  const Eigen::Vector3d slack(1.0 / noise.suspension_height_m, 1.0 / noise.suspension_tilt_rad,
                              1.0 / noise.suspension_tilt_rad);
  for (int i = 0; i < layout_.poses; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const RobotPose& pose = state.poses[k];
    if (increments && noise.along_way) {
      if (i > 0) visit_way(state, weighting, i, sink);
    } else if (increments) {
      if (i > 0) visit_increment(state, weighting, i, sink);
    } else {
      const Stop& stop = observations_.stops[k];
      visit_diagonal({pose.x_m - stop.x_m, pose.y_m - stop.y_m, wrap_angle(pose.yaw_rad - stop.yaw_rad)},
                     odometry_sigmas(k).cwiseInverse(), weighting, {i, 0, 2, Group::kOdometryXy, Group::kOdometryYaw},
                     sink);
    }
    visit_diagonal({pose.height_m, pose.roll_rad, pose.pitch_rad}, slack, weighting,
                   {i, 3, 1, Group::kSuspensionHeight, Group::kSuspensionTilt}, sink);
  }
}

template <bool kLens, typename Sink>
void Problem::visit_view_at_its_time(const State& state, Weighting weighting, const View& view, Sink& sink) const {
  const ImageTime time = time_of(view.after_stop_s);
  if (time == ImageTime::kByClock)
    visit_view<kLens, ImageTime::kByClock>(state, weighting, view, sink);
  else if (time == ImageTime::kByStamp)
    visit_view<kLens, ImageTime::kByStamp>(state, weighting, view, sink);
  else
    visit_view<kLens, ImageTime::kOfStop>(state, weighting, view, sink);
}

template <typename Sink>
void Problem::visit_blocks(const State& state, Weighting weighting, Sink&& sink) const {
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (view_left_out[v]) continue;
    if (layout_.with_intrinsics)
      visit_view_at_its_time<true>(state, weighting, views_[v], sink);
    else
      visit_view_at_its_time<false>(state, weighting, views_[v], sink);
  }
  for (const Plane& plane : board_planes_) {
    if (layout_.with_intrinsics)
      visit_board_plane_at_its_time<true>(state, weighting, plane, sink);
    else
      visit_board_plane_at_its_time<false>(state, weighting, plane, sink);
  }
  for (const Plane& plane : ground_planes_) visit_ground_plane(state, weighting, plane, sink);
  visit_poses(state, weighting, sink);
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
  if (layout_.with_clock_offsets) add(layout_.turn_lag(), state.turn_lag_s, priors_.turn_lag_s);
  for (int c = 0; c < layout_.cameras; ++c) {
    const std::size_t i = static_cast<std::size_t>(c);
    add(layout_.depth_bias(c), state.depth_bias[i], priors_.depth_bias[i]);
    if (layout_.with_clock_offsets) add(layout_.clock_offset(c), state.clock_offset_s[i], priors_.clock_offset_s);
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
  if (layout_.with_clock_offsets && priors_.turn_lag_s <= 0.0) system->fix_global_unknown(layout_.turn_lag());
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
  system.global = system.global.selfadjointView<Eigen::Lower>().toDenseMatrix();
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
  for (std::size_t i = increments ? 1 : 0; i < observations_.stops.size(); ++i) sum += log_odometry_variance(i);
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
  const RobotPose pose = pose_at_image(state, view.stop, view.camera, view.after_stop_s).pose;
  const ViewGeometry geometry = view_geometry(state.T_robot_camera[c], state.T_world_board, pose);
  ViewFit fit;
  if (view.corners.empty()) return fit;
  double square = 0.0, weight = 0.0;
  for (const Corner& corner : view.corners) {
    CornerResidual residual;
    if (!corner_residual(camera, geometry.T_camera_board * corner.point_board, corner.pixel, &residual)) continue;
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
