#include "step_scan.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "rigproof/calib/estimate/noise.h"

namespace rigproof::ml {
namespace {

using Coupling = Eigen::Matrix<double, Eigen::Dynamic, 6>;

// The gradient's square by its information, along the directions that the data determine: of what a body's views tell
// of its pose, less than this share is left by rounding.
double square_by(const Matrix6d& information, const Matrix6d& before_elimination, const Vector6d& gradient) {
  constexpr double kDetermined = 1e-7;
  const Vector6d unit = before_elimination.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(unit.asDiagonal() * information * unit.asDiagonal());
  const Vector6d along = eigen.eigenvectors().transpose() * unit.cwiseProduct(gradient);
  double square = 0.0;
  for (int i = 0; i < 6; ++i)
    if (eigen.eigenvalues()[i] > kDetermined) square += along[i] * along[i] / eigen.eigenvalues()[i];
  return square;
}

// Blocks by the information that the loss keeps have gradients whose variance is less than their information: by
// E[psi']^2 / E[w]^2.
double gradients_to_scores() {
  const LossMoments& moments = cauchy_moments(2);
  return std::pow(moments.weight / moments.weighted_square, 2);
}

}  // namespace

std::vector<int> splits_of(int stops, int most) {
  std::vector<int> splits;
  const int last = std::max(0, stops - 1), count = std::min(last, most);
  for (int i = 1; i <= count; ++i) splits.push_back(static_cast<int>(static_cast<long>(i) * last / count));
  return splits;
}

StepScan::StepScan(const Layout& layout, std::vector<int> splits) : layout_(layout), splits_(std::move(splits)) {
  Body body;
  body.poses.assign(static_cast<std::size_t>(layout.poses), Matrix6d::Zero());
  body.parts.assign(splits_.size() + 1, Part());
  for (Part& part : body.parts) part.globals = Coupling::Zero(layout.globals(), 6);
  bodies_.assign(static_cast<std::size_t>(layout.cameras + layout.boards), body);
  for (const int stepped : layout.step().bodies) bodies_[place_of(stepped)].has_step = true;
}

std::size_t StepScan::place_of(int body) const {
  return static_cast<std::size_t>(Step::is_board(body) ? layout_.cameras + Step::board_of(body) : body);
}

std::size_t StepScan::part_of(int stop) const {
  return static_cast<std::size_t>(std::upper_bound(splits_.begin(), splits_.end(), stop) - splits_.begin());
}

void StepScan::add(const LocalBlock& block) {
  if (block.group != Group::kCorners && block.group != Group::kGround && block.group != Group::kBoardPlane) return;
  const auto segment_at = [&block](int offset) {
    std::size_t i = 0;
    while (i < static_cast<std::size_t>(block.count) &&
           (block.segments[i].pose >= 0 || block.segments[i].offset != offset))
      ++i;
    return i;
  };
  const std::size_t count = static_cast<std::size_t>(block.count);
  std::size_t pose = 0;
  while (pose < count && block.segments[pose].pose < 0) ++pose;
  if (pose == count) return;
  const int stop = block.segments[pose].pose;
  if (const std::size_t i = segment_at(layout_.camera(block.camera)); i < count)
    add(block, i, stop, &bodies_[static_cast<std::size_t>(block.camera)]);
  for (int b = 0; b < layout_.boards; ++b)
    if (const std::size_t i = segment_at(layout_.board(b)); i < count)
      add(block, i, stop, &bodies_[place_of(Step::board(b))]);
}

void StepScan::add(const LocalBlock& block, std::size_t segment, int stop, Body* body) {
  if (body->has_step) return;
  Part& part = body->parts[part_of(stop)];
  const int own = block.starts[segment];
  if (block.group == Group::kCorners) ++part.views;
  part.gradient += block.g.segment<6>(own);
  part.information += block.H.block<6, 6>(own, own);
  for (std::size_t a = 0; a < static_cast<std::size_t>(block.count); ++a) {
    const Segment& other = block.segments[a];
    const int start = block.starts[a];
    // Only blocks on and below the diagonal are there.
    const auto add_to = [&](auto&& rows) {
      if (a >= segment)
        rows += block.H.block(start, own, other.size, 6);
      else
        rows += block.H.block(own, start, 6, other.size).transpose();
    };
    if (other.pose < 0)
      add_to(part.globals.middleRows(other.offset, other.size));
    else
      add_to(body->poses[static_cast<std::size_t>(other.pose)].middleRows(other.offset, other.size));
  }
}

// As one body that moves in the robot's frame by (dt, w): each camera by dt + w x t, and R' w about its own axes.
StepScan::Body StepScan::all_cameras(const State& state) const {
  Body all = bodies_.back();
  for (int b = 0; b < layout_.boards; ++b) all.has_step = all.has_step || bodies_[place_of(Step::board(b))].has_step;
  for (Matrix6d& pose : all.poses) pose.setZero();
  for (Part& part : all.parts) {
    const Eigen::Index globals = part.globals.rows();
    part = Part();
    part.globals = Coupling::Zero(globals, 6);
  }
  for (std::size_t c = 0; c < static_cast<std::size_t>(layout_.cameras); ++c) {
    const Rigid3& T = state.T_robot_camera[c];
    Matrix6d M = Matrix6d::Zero();
    M.topLeftCorner<3, 3>().setIdentity();
    M.topRightCorner<3, 3>() = -skew(T.translation);
    M.bottomRightCorner<3, 3>() = T.rotation_matrix().transpose();
    for (std::size_t i = 0; i < all.poses.size(); ++i) all.poses[i] += bodies_[c].poses[i] * M;
    for (std::size_t k = 0; k < all.parts.size(); ++k) {
      const Part& part = bodies_[c].parts[k];
      all.parts[k].information += M.transpose() * part.information * M;
      all.parts[k].gradient += M.transpose() * part.gradient;
      all.parts[k].globals += part.globals * M;
      all.parts[k].views += part.views;
    }
    all.has_step = all.has_step || bodies_[c].has_step;
  }
  return all;
}

void StepScan::score(const Body& body, const std::vector<int>& bodies, const Solution& at,
                     std::vector<StepScore>* scores) const {
  if (body.has_step) return;
  int views = 0;
  for (const Part& part : body.parts) views += part.views;
  if (views < 2 * kLeastViewsOfStep) return;
  const std::vector<Matrix6d> by_poses = at.eliminated.squares_from_each_pose(body.poses);
  const Eigen::Index globals = at.covariance.rows();
  Part after;
  after.globals = Coupling::Zero(globals, 6);
  int stop = static_cast<int>(body.poses.size());
  for (std::size_t k = splits_.size(); k-- > 0;) {
    const Part& part = body.parts[k + 1];
    after.information += part.information;
    after.gradient += part.gradient + part.globals.transpose() * at.globals;
    after.globals += part.globals;
    after.views += part.views;
    for (; stop > splits_[k]; --stop) {
      const Matrix6d& pose = body.poses[static_cast<std::size_t>(stop) - 1];
      after.gradient += pose.transpose() * at.poses.segment<6>(6 * (stop - 1));
      // Of the globals' coupling what the poses do not take along.
      after.globals.noalias() -= at.response.topRows(globals).middleCols<6>(6 * (stop - 1)) * pose;
    }
    if (after.views < kLeastViewsOfStep || views - after.views < kLeastViewsOfStep) continue;
    const Matrix6d information = after.information - by_poses[static_cast<std::size_t>(splits_[k])] -
                                 after.globals.transpose() * (at.covariance * after.globals);
    const double square = gradients_to_scores() * square_by(information, after.information, after.gradient);
    if (std::isfinite(square)) scores->push_back({{splits_[k], bodies}, square});
  }
}

std::vector<StepScore> StepScan::scores(const State& state, const EliminatedSystem& eliminated,
                                        const Eigen::MatrixXd& globals) const {
  Solution at{eliminated, globals, eliminated.pose_response(), -globals * eliminated.schur_gradient(), {}};
  at.poses =
      -at.response.topRows(globals.rows()).transpose() * at.globals - at.response.row(globals.rows()).transpose();
  std::vector<StepScore> scores;
  std::vector<int> cameras;
  for (int c = 0; c < layout_.cameras; ++c) {
    cameras.push_back(c);
    score(bodies_[static_cast<std::size_t>(c)], {c}, at, &scores);
  }
  for (int b = 0; b < layout_.boards; ++b) score(bodies_[place_of(Step::board(b))], {Step::board(b)}, at, &scores);
  if (cameras.size() > 1) score(all_cameras(state), cameras, at, &scores);
  return scores;
}

}  // namespace rigproof::ml
