// The whitened least-squares problem: its cost, its normal equations and what each group of residuals contributes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "rigproof/calib/estimate/arrow_system.h"
#include "rigproof/calib/estimate/board_place.h"
#include "rigproof/calib/estimate/group_sums.h"
#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/odometry_way.h"
#include "rigproof/calib/estimate/repeating_errors.h"
#include "rigproof/calib/estimate/state.h"
#include "rigproof/calib/estimate/step_scores.h"
#include "rigproof/calib/estimate/weighting.h"
#include "rigproof/calib/estimate/whitened.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

class BlockSink;
struct Evaluation;
/// Root mean square of the reprojection error of a view, and the mean weight of its corners.
struct ViewFit {
  double rms_px = 0.0;
  double mean_weight = 0.0;
};

/// How the corners of a view pull at it as a whole: by turning its camera.
struct ViewPull {
  double square = 0.0;    ///< whitened: by the corners' noise alone three, less what the estimate absorbs
  double leverage = 0.0;  ///< dimensions that the estimate absorbs
  int corners = 0;
};

/// Whitened observations with the noise levels that may change between solutions.
class Problem {
 public:
  /// @param whitened the observations, if they were whitened before; null: they are whitened
  explicit Problem(const Observations& observations, const Priors& priors, const NoiseLevels& noise,
                   std::shared_ptr<const Whitened> whitened = nullptr);

  /// From a stop on some bodies have second poses, those of the state.
  void add(const Step& step) { layout_.add(step); }
  const Layout& layout() const { return layout_; }
  const Observations& observations() const { return observations_; }
  const Priors& priors() const { return priors_; }
  NoiseLevels noise;
  CauchyLoss loss;

  /// Normal equations at the state, with cost and sums where wanted.
  ArrowSystem linearise(const State& state, Weighting weighting, double* cost, GroupSums* sums) const;
  /// The same with the repeating errors as further globals, after all others, and fine fields.
  ArrowSystem linearise_with(const RemovedErrors& removed, const State& state, Weighting weighting) const;
  /// Dimensions of each group that the estimate absorbs, and of corners those that errors taken out of them did: its
  /// leverage.
  void add_leverage(const State& state, const EliminatedSystem::PoseCovariance& poses, const Eigen::MatrixXd& globals,
                    GroupSums* sums) const;
  /// Sums of all groups with leverage, weighted by the information that the loss keeps; absent if the poses are not
  /// determined.
  std::optional<GroupSums> sums_with_leverage(const State& state) const {
    return sums_with_leverage(state, {}, nullptr);
  }
  /// The same, and the scores of steps at the given splits.
  std::optional<GroupSums> sums_with_leverage(const State& state, const std::vector<int>& splits,
                                              std::vector<StepScore>* scores) const;
  /// -2 ln of the normalisation of the residuals: sum of 2 ln sigma over every residual whose sigma may be estimated.
  double log_normalisation() const;
  /// Every factor's block of normal equations at the state.
  void visit_blocks(const State& state, Weighting weighting, BlockSink* sink) const;
  /// Every prior that counts: of which row, where its unknowns stand among the globals, its information.
  void for_each_prior(const std::function<void(Nuisance, int, const Eigen::MatrixXd&)>& visit) const;
  /// Of the boards whose place against the first one is stated, where views of both count.
  std::vector<PlaceError> place_errors(const State& state) const;
  ViewFit view_fit(const State& state, std::size_t view) const;
  /// One for each board view, none of those left out or taken at speed, of which the displacement is an unknown; absent
  /// if the poses are not determined.
  std::optional<std::vector<ViewPull>> view_pulls(const State& state) const;
  /// Whether each view is left out.
  std::vector<bool> view_left_out;
  /// Cameras that saw nothing stay where they are.
  std::vector<bool> camera_fixed;
  /// Of each camera: dimensions that errors that were taken out of its corners absorbed (RemovedErrors). Empty: none.
  std::vector<double> corners_absorbed;

  GroupSums empty_sums() const;

 private:
  struct Besides {
    const RemovedErrors* removed = nullptr;  // further globals
    BlockSink* also = nullptr;               // is shown every block
  };
  ArrowSystem linearised(const State& state, Weighting weighting, const Besides& besides, double* cost,
                         GroupSums* sums) const;
  Evaluation at(const State& state, Weighting weighting) const;
  void visit_odometry(const Evaluation& at, int stop, BlockSink* sink) const;
  // Absolute odometry does not depend on some rows.
  bool counts(Nuisance nuisance) const;
  void add_priors(const State& state, ArrowSystem* system, double* cost) const;
  // Of each board whether any view that counts is of it: one without stays where it is, and its depth does not count.
  std::vector<bool> shown_boards() const;
  void fix_unknowns(ArrowSystem* system) const;

  const Observations& observations_;
  Layout layout_;
  Priors priors_;
  std::shared_ptr<const Whitened> whitened_;
  std::vector<VeeringIncrement> increments_;  // [i]: from stop i to i + 1
  std::vector<OdometryWay> ways_;             // the same; only if the noise is that of the way
};

}  // namespace rigproof::ml
