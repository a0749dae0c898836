#include "pattern_bundle.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "rigproof/core/median.h"

namespace rigproof::rivals {
namespace {

constexpr int kMaxIterations = 100;
constexpr double kLossMedians = 3.0;
constexpr double kMinLoss_px = 0.01;
// A view that the loss weighs less than this says nothing about the cameras.
constexpr double kLeastViewWeight = 0.1;

/// One view of the part: indices into its cameras and stops.
struct View {
  const BoardView* seen;
  std::size_t camera, stop;
};

/// Normal equations of one view; the camera's columns first, then the board's.
struct ViewSystem {
  View view;
  Eigen::Matrix<double, 12, 12> H = Eigen::Matrix<double, 12, 12>::Zero();
  Eigen::Matrix<double, 12, 1> g = Eigen::Matrix<double, 12, 1>::Zero();
  double squared_px = 0.0;
  bool valid = true;

  double corners() const { return static_cast<double>(view.seen->corners.size()); }
  double mean_squared_px() const { return squared_px / corners(); }
  double weight(double loss_px) const { return 1.0 / (1.0 + mean_squared_px() / (loss_px * loss_px)); }
};
using Systems = std::vector<ViewSystem>;

std::vector<View> views_of(const Observations& observations, const PatternPart& part) {
  std::vector<View> views;
  for (const BoardView& seen : observations.board_views) {
    const auto camera = std::find(part.cameras.begin(), part.cameras.end(), seen.camera);
    const auto stop = std::find(part.stops.begin(), part.stops.end(), seen.stop);
    if (camera == part.cameras.end() || stop == part.stops.end()) continue;
    views.push_back({&seen, static_cast<std::size_t>(camera - part.cameras.begin()),
                     static_cast<std::size_t>(stop - part.stops.begin())});
  }
  return views;
}

ViewSystem system_of(const Observations& observations, const View& view, const PatternPart& part) {
  const Camera& camera = observations.cameras[static_cast<std::size_t>(view.seen->camera)].camera;
  const Rigid3 &E = part.T_camera_root[view.camera], &P = part.T_root_board[view.stop];
  const Eigen::Matrix3d R = E.rotation_matrix();
  ViewSystem system{view};
  for (const CornerObservation& corner : view.seen->corners) {
    const Eigen::Vector3d in_board = P.rotation * observations.board.corner(corner.id);
    const Eigen::Vector3d turned = R * (in_board + P.translation);
    Eigen::Vector2d pixel;
    Eigen::Matrix<double, 2, 3> J_point;
    if (!camera.project(turned + E.translation, &pixel, &J_point)) {
      system.valid = false;
      return system;
    }
    Eigen::Matrix<double, 2, 12> J;
    J << J_point, -J_point * skew(turned), J_point * R, -J_point * R * skew(in_board);
    const Eigen::Vector2d error = pixel - corner.pixel;
    system.H.noalias() += J.transpose() * J;
    system.g.noalias() += J.transpose() * error;
    system.squared_px += error.squaredNorm();
  }
  return system;
}

Systems linearise(const Observations& observations, const std::vector<View>& views, const PatternPart& part) {
  Systems systems;
  for (const View& view : views) systems.push_back(system_of(observations, view, part));
  return systems;
}

// Absent where no view is valid.
std::optional<double> loss_of(const Systems& systems) {
  std::vector<double> sizes;
  for (const ViewSystem& system : systems)
    if (system.valid) sizes.push_back(std::sqrt(system.mean_squared_px()));
  if (sizes.empty()) return std::nullopt;
  return std::max(kMinLoss_px, kLossMedians * median(std::move(sizes)));
}

double cost(const Systems& systems, double loss_px) {
  double sum = 0.0;
  for (const ViewSystem& system : systems) {
    if (!system.valid) return std::numeric_limits<double>::infinity();
    sum += system.corners() * std::log1p(system.mean_squared_px() / (loss_px * loss_px));
  }
  return sum;
}

// The root does not move.
Eigen::Index column(std::size_t camera) { return 6 * (static_cast<Eigen::Index>(camera) - 1); }

// The normal equations without the stops.
struct Reduced {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::vector<Matrix6d> stop_inverse;
  std::vector<Vector6d> stop_g;
};

void eliminate_stops(const Systems& systems, double loss_px, Reduced* reduced) {
  for (const ViewSystem& a : systems) {
    if (a.view.camera == 0) continue;
    const Eigen::Index c = column(a.view.camera);
    const Matrix6d W = a.weight(loss_px) * a.H.topRightCorner<6, 6>() * reduced->stop_inverse[a.view.stop];
    reduced->g.segment<6>(c) -= W * reduced->stop_g[a.view.stop];
    for (const ViewSystem& b : systems) {
      if (b.view.stop != a.view.stop || b.view.camera == 0) continue;
      reduced->H.block<6, 6>(c, column(b.view.camera)) -= W * b.weight(loss_px) * b.H.bottomLeftCorner<6, 6>();
    }
  }
}

Reduced reduce(const Systems& systems, const PatternPart& part, double loss_px, double damping) {
  const Eigen::Index parameters = column(part.cameras.size());
  Reduced reduced{Eigen::MatrixXd::Zero(parameters, parameters), Eigen::VectorXd::Zero(parameters), {}, {}};
  std::vector<Matrix6d> H_stop(part.stops.size(), Matrix6d::Zero());
  reduced.stop_g.assign(part.stops.size(), Vector6d::Zero());
  for (const ViewSystem& system : systems) {
    const double w = system.weight(loss_px);
    H_stop[system.view.stop] += w * system.H.bottomRightCorner<6, 6>();
    reduced.stop_g[system.view.stop] += w * system.g.tail<6>();
    if (system.view.camera == 0) continue;
    const Eigen::Index c = column(system.view.camera);
    reduced.H.block<6, 6>(c, c) += w * system.H.topLeftCorner<6, 6>();
    reduced.g.segment<6>(c) += w * system.g.head<6>();
  }
  reduced.H.diagonal() *= 1.0 + damping;
  for (Matrix6d& H : H_stop) {
    H.diagonal() *= 1.0 + damping;
    reduced.stop_inverse.push_back(H.ldlt().solve(Matrix6d::Identity()));
  }
  eliminate_stops(systems, loss_px, &reduced);
  return reduced;
}

// Where the search stands: the systems are linearised at the part.
struct Iterate {
  PatternPart part;
  Systems systems;
  double damping = 1e-4;
};

PatternPart stepped(const Iterate& at, double loss_px, double* size) {
  const Reduced reduced = reduce(at.systems, at.part, loss_px, at.damping);
  const Eigen::VectorXd step = reduced.H.ldlt().solve(-reduced.g);
  PatternPart part = at.part;
  for (std::size_t k = 1; k < part.cameras.size(); ++k)
    part.T_camera_root[k] = apply_transform_error(part.T_camera_root[k], step.segment<6>(column(k)));
  std::vector<Vector6d> right = reduced.stop_g;
  for (const ViewSystem& system : at.systems)
    if (system.view.camera > 0)
      right[system.view.stop] +=
          system.weight(loss_px) * system.H.bottomLeftCorner<6, 6>() * step.segment<6>(column(system.view.camera));
  *size = step.size() > 0 ? step.norm() : 0.0;
  for (std::size_t s = 0; s < part.stops.size(); ++s) {
    const Vector6d stop_step = -(reduced.stop_inverse[s] * right[s]);
    *size = std::max(*size, stop_step.norm());
    part.T_root_board[s] = apply_transform_error(part.T_root_board[s], stop_step);
  }
  return part;
}

bool minimise(const Observations& observations, const std::vector<View>& views, double loss_px, Iterate* at) {
  double best = cost(at->systems, loss_px);
  for (int iteration = 0; iteration < kMaxIterations && at->damping < 1e10; ++iteration) {
    double size = 0.0;
    PatternPart part = stepped(*at, loss_px, &size);
    if (!std::isfinite(size)) return false;
    Systems systems = linearise(observations, views, part);
    const double now = cost(systems, loss_px);
    if (size < 1e-11) return true;
    if (now < best) {
      best = now;
      *at = {std::move(part), std::move(systems), std::max(1e-12, 0.2 * at->damping)};
    } else {
      at->damping *= 10.0;
    }
    if (size < 1e-9) return true;
  }
  return at->damping < 1e10;
}

PatternBundle stated(const Iterate& at, double loss_px, bool converged) {
  PatternBundle bundle;
  bundle.part = at.part;
  bundle.converged = converged;
  double squared = 0.0, weights = 0.0;
  for (const ViewSystem& system : at.systems) {
    const double w = system.weight(loss_px);
    if (w < kLeastViewWeight) {
      bundle.outliers.emplace_back(system.view.seen->stop, system.view.seen->camera);
      continue;
    }
    bundle.corners += static_cast<int>(system.view.seen->corners.size());
    squared += w * system.squared_px;
    weights += w * system.corners();
  }
  bundle.rms_px = weights > 0.0 ? std::sqrt(squared / weights) : 0.0;
  const Eigen::MatrixXd H = reduce(at.systems, at.part, loss_px, 0.0).H;
  const double unknowns = static_cast<double>(H.rows()) + 6.0 * static_cast<double>(at.part.stops.size());
  const double redundancy = std::max(1.0, 2.0 * weights - unknowns);
  bundle.covariance = squared / redundancy * H.ldlt().solve(Eigen::MatrixXd::Identity(H.rows(), H.rows()));
  return bundle;
}

}  // namespace

PatternBundle adjust_pattern(const Observations& observations, const PatternPart& start) {
  const std::vector<View> views = views_of(observations, start);
  Iterate at{start, {}};
  double loss_px = 1e3;
  bool converged = false;
  // Loss scales follow the residuals: a few rounds settle both.
  for (int round = 0; round < 4; ++round) {
    at.systems = linearise(observations, views, at.part);
    loss_px = loss_of(at.systems).value_or(loss_px);
    converged = minimise(observations, views, loss_px, &at);
  }
  return stated(at, loss_px, converged);
}

}  // namespace rigproof::rivals
