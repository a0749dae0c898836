#include "robust_views.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/whitened.h"
#include "rigproof/core/median.h"

namespace rigproof::ml {
namespace {

// Least squares spreads a wrong corner over the view: from this many sigmas rms the view is looked at again.
constexpr double kSuspiciousRms = 2.5;

using Corner = WhitenedView::Corner;

struct Step {
  Matrix6d H = Matrix6d::Zero();  // in the chart of transform_error()
  Vector6d g = Vector6d::Zero();
  std::vector<double> squares;
};

bool linearise(const Camera& camera, const std::vector<Corner>& corners, const Rigid3& T, const CauchyLoss& loss,
               Step* step) {
  for (const Corner& corner : corners) {
    const Eigen::Vector3d turned = T.rotation * corner.point_board;
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> J_point;
    if (!camera.project(turned + T.translation, &pixel, &J_point)) return false;
    Eigen::Matrix<double, 2, 6> J;
    J << J_point, -J_point * skew(turned);
    J = (corner.whitening * J).eval();
    const Eigen::Vector2d r = corner.whitening * (pixel - corner.pixel);
    const double s = r.squaredNorm(), w = loss.weight(s);
    step->H += w * J.transpose() * J;
    step->g += w * J.transpose() * r;
    step->squares.push_back(s);
  }
  return true;
}

void refine(const Camera& camera, const std::vector<Corner>& corners, ViewPose* view) {
  constexpr int kIterations = 25;
  constexpr double kMedianSquare = 1.386;  // of a whitened residual of two dimensions: 2 ln 2
  Rigid3 T = view->T_camera_board;
  double scale2 = 1.0;
  Step last;
  for (int i = 0; i < kIterations; ++i) {
    Step probe;
    if (!linearise(camera, corners, T, CauchyLoss(), &probe)) return;
    scale2 = std::max(1.0, median(probe.squares) / kMedianSquare);
    CauchyLoss loss;
    loss.c2 *= scale2;
    last = Step();
    if (!linearise(camera, corners, T, loss, &last)) return;
    const Vector6d step = -last.H.ldlt().solve(last.g);
    if (!step.allFinite()) return;
    T = apply_transform_error(T, step);
    if (step.dot(last.H * step) < 1e-6 * scale2) break;
  }
  const LossMoments& moments = cauchy_moments(2);
  view->T_camera_board = T;
  view->covariance = last.H.inverse() * (scale2 * moments.weight / moments.efficiency);
}

}  // namespace

void refine_robustly(const Observations& observations, std::vector<ViewPose>* views) {
  for (ViewPose& view : *views) {
    const BoardView& observed = observations.board_views[static_cast<std::size_t>(view.view)];
    const Camera& camera = observations.cameras[static_cast<std::size_t>(view.camera)].camera;
    const std::vector<Corner> corners = whitened_corners(observed, observations.board_of(observed));
    Step fit;
    if (!linearise(camera, corners, view.T_camera_board, CauchyLoss(), &fit)) continue;
    double sum = 0.0;
    for (const double square : fit.squares) sum += square;
    if (sum < kSuspiciousRms * kSuspiciousRms * 2.0 * static_cast<double>(corners.size())) continue;
    refine(camera, corners, &view);
  }
}

}  // namespace rigproof::ml
