// Errors that last from one drive to the next, as the earlier one left them: priors of the later one.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "rigproof/calib/estimate/lasting.h"
#include "rigproof/calib/estimate/problem.h"
#include "rigproof/core/result.h"

namespace rigproof::moved {

/// The errors of the cameras and boards for which `keeps` holds.
LastingErrors only_of(const std::function<bool(const LastingErrors::Owner&)>& keeps, LastingErrors lasting);

/// In place of what is stated of the same errors.
class KeptErrors {
 public:
  /// Those that the problem has among its unknowns; it must outlive this.
  KeptErrors(const LastingErrors& lasting, const ml::Problem& problem);

  /// To normal equations at the state.
  void add_to(const ml::State& state, ml::ArrowSystem* system) const;

  /// Where the earlier drive would have put its cameras (six a camera) had it known the lasting errors as they are
  /// known now: the shift by each global, and that by all of them at the state.
  Eigen::MatrixXd cameras_by_globals() const;
  Eigen::VectorXd shift_of_cameras(const ml::State& state) const;
  /// What of the cameras' covariance would be left then.
  Eigen::MatrixXd covariance_left(const Eigen::MatrixXd& of_cameras) const;

 private:
  // An unknown of the problem, and where among the lasting errors it is.
  struct Kept {
    ml::LastingUnknown unknown;
    Eigen::Index row;
  };
  static std::vector<Kept> common_to(const LastingErrors& lasting, const ml::Problem& problem);
  Eigen::VectorXd now(const ml::State& state) const;

  const ml::Problem& problem_;
  std::vector<Eigen::Index> places_;        // among the globals
  Eigen::VectorXd value_;                   // as they were left
  Eigen::MatrixXd information_;             // of it, together
  Eigen::VectorXd stated_information_;      // of each, which counts no more
  Eigen::MatrixXd with_cameras_, by_each_;  // covariance with the earlier cameras; the same times the information
};

}  // namespace rigproof::moved
