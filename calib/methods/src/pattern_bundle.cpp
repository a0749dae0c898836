#include "pattern_bundle.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
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
  Eigen::Matrix<double, 12, 12> H = Eigen::Matrix<double, 12, 12>::Zero();
  Eigen::Matrix<double, 12, 1> g = Eigen::Matrix<double, 12, 1>::Zero();
  double squared_px = 0.0;
  bool valid = true;

  double mean_squared_px(std::size_t corners) const { return squared_px / static_cast<double>(corners); }
};

class Bundle {
 public:
  Bundle(const Observations& observations, const PatternPart& start) : observations_(observations) {
    result_.part = start;
    for (const BoardView& seen : observations.board_views) {
      const auto camera = std::find(start.cameras.begin(), start.cameras.end(), seen.camera);
      const auto stop = std::find(start.stops.begin(), start.stops.end(), seen.stop);
      if (camera == start.cameras.end() || stop == start.stops.end()) continue;
      views_.push_back({&seen, static_cast<std::size_t>(camera - start.cameras.begin()),
                        static_cast<std::size_t>(stop - start.stops.begin())});
    }
    parameters_ = 6 * (static_cast<Eigen::Index>(start.cameras.size()) - 1);
  }

  PatternBundle solve() {
    double damping = 1e-4;
    // Loss scales follow the residuals: a few rounds settle both.
    for (int round = 0; round < 4; ++round) {
      linearise(result_.part, &systems_);
      choose_loss();
      result_.converged = minimise(&damping);
    }
    finish();
    return std::move(result_);
  }

 private:
  ViewSystem system_of(const PatternPart& part, const View& view) const {
    const Camera& camera = observations_.cameras[static_cast<std::size_t>(view.seen->camera)].camera;
    const Rigid3 &E = part.T_camera_root[view.camera], &P = part.T_root_board[view.stop];
    const Eigen::Matrix3d R = E.rotation_matrix();
    ViewSystem system;
    for (const CornerObservation& corner : view.seen->corners) {
      const Eigen::Vector3d in_board = P.rotation * observations_.board.corner(corner.id);
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

  void linearise(const PatternPart& part, std::vector<ViewSystem>* systems) const {
    systems->clear();
    for (const View& view : views_) systems->push_back(system_of(part, view));
  }

  void choose_loss() {
    std::vector<double> sizes;
    for (std::size_t i = 0; i < views_.size(); ++i)
      if (systems_[i].valid) sizes.push_back(std::sqrt(systems_[i].mean_squared_px(views_[i].seen->corners.size())));
    if (sizes.empty()) return;
    loss_px_ = std::max(kMinLoss_px, kLossMedians * median(std::move(sizes)));
  }

  double weight(std::size_t i, const std::vector<ViewSystem>& systems) const {
    const double squared = systems[i].mean_squared_px(views_[i].seen->corners.size());
    return 1.0 / (1.0 + squared / (loss_px_ * loss_px_));
  }

  double cost(const std::vector<ViewSystem>& systems) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (!systems[i].valid) return std::numeric_limits<double>::infinity();
      const double corners = static_cast<double>(views_[i].seen->corners.size());
      sum += corners * std::log1p(systems[i].squared_px / corners / (loss_px_ * loss_px_));
    }
    return sum;
  }

  // The root does not move.
  Eigen::Index column(std::size_t camera) const { return 6 * (static_cast<Eigen::Index>(camera) - 1); }

  struct Reduced {
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
    std::vector<Matrix6d> stop_inverse;
    std::vector<Vector6d> stop_g;
  };

  Reduced reduce(double damping) const {
    const std::size_t stops = result_.part.stops.size();
    Reduced reduced{Eigen::MatrixXd::Zero(parameters_, parameters_), Eigen::VectorXd::Zero(parameters_), {}, {}};
    std::vector<Matrix6d> H_stop(stops, Matrix6d::Zero());
    reduced.stop_g.assign(stops, Vector6d::Zero());
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const double w = weight(i, systems_);
      H_stop[views_[i].stop] += w * systems_[i].H.bottomRightCorner<6, 6>();
      reduced.stop_g[views_[i].stop] += w * systems_[i].g.tail<6>();
      if (views_[i].camera == 0) continue;
      const Eigen::Index c = column(views_[i].camera);
      reduced.H.block<6, 6>(c, c) += w * systems_[i].H.topLeftCorner<6, 6>();
      reduced.g.segment<6>(c) += w * systems_[i].g.head<6>();
    }
    reduced.H.diagonal() *= 1.0 + damping;
    for (Matrix6d& H : H_stop) {
      H.diagonal() *= 1.0 + damping;
      reduced.stop_inverse.push_back(H.ldlt().solve(Matrix6d::Identity()));
    }
    eliminate_stops(&reduced);
    return reduced;
  }

  void eliminate_stops(Reduced* reduced) const {
    for (std::size_t i = 0; i < views_.size(); ++i) {
      if (views_[i].camera == 0) continue;
      const std::size_t stop = views_[i].stop;
      const Eigen::Index c = column(views_[i].camera);
      const Matrix6d W = weight(i, systems_) * systems_[i].H.topRightCorner<6, 6>() * reduced->stop_inverse[stop];
      reduced->g.segment<6>(c) -= W * reduced->stop_g[stop];
      for (std::size_t j = 0; j < views_.size(); ++j) {
        if (views_[j].stop != stop || views_[j].camera == 0) continue;
        reduced->H.block<6, 6>(c, column(views_[j].camera)) -=
            W * weight(j, systems_) * systems_[j].H.bottomLeftCorner<6, 6>();
      }
    }
  }

  PatternPart stepped(const Reduced& reduced, double* size) const {
    const Eigen::VectorXd step = reduced.H.ldlt().solve(-reduced.g);
    PatternPart part = result_.part;
    for (std::size_t k = 1; k < part.cameras.size(); ++k)
      part.T_camera_root[k] = apply_transform_error(part.T_camera_root[k], step.segment<6>(column(k)));
    std::vector<Vector6d> right = reduced.stop_g;
    for (std::size_t i = 0; i < views_.size(); ++i)
      if (views_[i].camera > 0)
        right[views_[i].stop] +=
            weight(i, systems_) * systems_[i].H.bottomLeftCorner<6, 6>() * step.segment<6>(column(views_[i].camera));
    *size = step.size() > 0 ? step.norm() : 0.0;
    for (std::size_t s = 0; s < part.stops.size(); ++s) {
      const Vector6d stop_step = -(reduced.stop_inverse[s] * right[s]);
      *size = std::max(*size, stop_step.norm());
      part.T_root_board[s] = apply_transform_error(part.T_root_board[s], stop_step);
    }
    return part;
  }

  bool minimise(double* damping) {
    double best = cost(systems_);
    std::vector<ViewSystem> systems;
    for (int iteration = 0; iteration < kMaxIterations && *damping < 1e10; ++iteration) {
      double size = 0.0;
      const PatternPart part = stepped(reduce(*damping), &size);
      if (!std::isfinite(size)) return false;
      linearise(part, &systems);
      const double now = cost(systems);
      if (size < 1e-11) return true;
      if (now < best) {
        best = now;
        result_.part = part;
        systems_.swap(systems);
        *damping = std::max(1e-12, 0.2 * *damping);
      } else {
        *damping *= 10.0;
      }
      if (size < 1e-9) return true;
    }
    return *damping < 1e10;
  }

  void finish() {
    double squared = 0.0, weights = 0.0;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const double w = weight(i, systems_);
      const int corners = static_cast<int>(views_[i].seen->corners.size());
      if (w < kLeastViewWeight) {
        result_.outliers.emplace_back(views_[i].seen->stop, views_[i].seen->camera);
        continue;
      }
      result_.corners += corners;
      squared += w * systems_[i].squared_px;
      weights += w * corners;
    }
    result_.rms_px = weights > 0.0 ? std::sqrt(squared / weights) : 0.0;
    const double unknowns = static_cast<double>(parameters_) + 6.0 * static_cast<double>(result_.part.stops.size());
    const double redundancy = std::max(1.0, 2.0 * weights - unknowns);
    result_.covariance =
        squared / redundancy * reduce(0.0).H.ldlt().solve(Eigen::MatrixXd::Identity(parameters_, parameters_));
  }

  const Observations& observations_;
  std::vector<View> views_;
  std::vector<ViewSystem> systems_;
  Eigen::Index parameters_ = 0;
  double loss_px_ = 1e3;
  PatternBundle result_;
};

}  // namespace

PatternBundle adjust_pattern(const Observations& observations, const PatternPart& start) {
  return Bundle(observations, start).solve();
}

}  // namespace rigproof::rivals
