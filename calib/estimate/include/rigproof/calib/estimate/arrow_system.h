// Normal equations with the estimator's shape: poses coupled in a chain, and a few globals coupled to all of them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "rigproof/core/rigid3.h"

namespace rigproof::ml {

/// Six rows a pose, a column for each global; the rows of one unknown lie together.
using PoseRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Many unknowns that the images of one camera tell and nothing else does: the numbers of its fine field.
struct FieldEquations {
  FieldEquations(int poses, int globals, int numbers);

  Eigen::MatrixXd own;           ///< with their priors; below the diagonal
  PoseRows with_poses;           ///< 6 poses x numbers
  Eigen::MatrixXd with_globals;  ///< globals x numbers
  Eigen::VectorXd gradient;

  /// Their step, by those of poses and globals.
  Eigen::VectorXd step(const Eigen::VectorXd& pose_step, const Eigen::VectorXd& global_step) const;
  /// Rows of the inverse of all equations: their columns, by those of poses and globals.
  Eigen::MatrixXd columns_of_inverse(const Eigen::MatrixXd& of_poses, const Eigen::MatrixXd& of_globals) const;
};

/// H = [P U; U' C] with P block tridiagonal (6x6 blocks), and the gradient g. Fields, if there are any, couple with
/// both.
struct ArrowSystem {
  ArrowSystem(int poses, int globals);

  std::vector<Matrix6d> diagonal;   ///< P(i, i)
  std::vector<Matrix6d> coupling;   ///< P(i, i - 1); the first is unused
  PoseRows pose_global;             ///< U, 6 poses x globals
  Eigen::MatrixXd global;           ///< C
  Eigen::VectorXd pose_gradient;    ///< 6 poses
  Eigen::VectorXd global_gradient;  ///< globals
  std::vector<FieldEquations> fields;

  int poses() const { return static_cast<int>(diagonal.size()); }
  int globals() const { return static_cast<int>(global.rows()); }
  int fixed_unknowns = 0;
  /// Removes an unknown of a pose from the equations: its step and its variance are zero.
  void fix_pose_unknown(int pose, int unknown);
  void fix_global_unknown(int unknown);
};

/// H after eliminating the poses: linear in their number. Fields are eliminated, too.
class EliminatedSystem {
 public:
  /// @param damping the diagonal is multiplied by 1 + damping; 0 where there are fields. Absent if P is not positive
  /// definite.
  static std::optional<EliminatedSystem> eliminate(const ArrowSystem& system, double damping);

  /// C - U' P^-1 U.
  const Eigen::MatrixXd& schur() const { return schur_; }
  /// The gradient of the globals, the poses following.
  const Eigen::VectorXd& schur_gradient() const { return schur_gradient_; }
  /// Step -H^-1 g of poses and globals; false if the Schur complement is not positive definite.
  bool step(Eigen::VectorXd* pose_step, Eigen::VectorXd* global_step) const;
  /// Without fields, as what follows.
  double log_determinant_of_poses() const { return log_determinant_; }
  /// log det of the Schur complement; not a number if it is not positive definite.
  double log_determinant_of_globals() const;

  /// Blocks of H^-1 for given inverse of the Schur complement.
  struct PoseCovariance {
    std::vector<Matrix6d> diagonal;       ///< (i, i)
    std::vector<Matrix6d> with_previous;  ///< (i, i - 1)
    PoseRows with_globals;                ///< 6 poses x globals
  };
  PoseCovariance pose_covariance(const Eigen::MatrixXd& global_covariance) const;
  /// With six columns B that couple to the poses, six rows B_i each: for every pose k the sum of B_i' (P^-1)_ij B_j
  /// over all i, j >= k. Linear in the number of poses.
  std::vector<Matrix6d> squares_from_each_pose(const std::vector<Matrix6d>& B) const;

  /// (P^-1 [U g])', with fields after these have followed: a row for each global, then one of the gradient; six
  /// columns a pose.
  Eigen::MatrixXd pose_response() const;

 private:
  static std::optional<EliminatedSystem> fields_first(const ArrowSystem& system);
  static std::optional<EliminatedSystem> fields_last(const ArrowSystem& system);
  // D^-1 y, then backwards through the chain: the rest of P^-1 after the elimination's L^-1. Six columns a pose.
  void solve_backwards(Eigen::MatrixXd* transposed) const;

  std::vector<Matrix6d> inverse_pivot_;  // D_i^-1 of P = L D L'
  std::vector<Matrix6d> factor_;         // L(i, i - 1)
  Eigen::MatrixXd forward_;              // (L^-1 [U g])'
  Eigen::MatrixXd response_;             // pose_response(); only with fields
  Eigen::MatrixXd schur_;
  Eigen::VectorXd schur_gradient_;
  double log_determinant_ = 0.0;
};

/// Covariance of the globals: the inverse of the Schur complement, without the directions that nothing determines.
struct GlobalCovariance {
  Eigen::MatrixXd covariance;
  /// Directions (columns) of the globals that the data leave free, in units of the globals.
  Eigen::MatrixXd free_directions;
};
GlobalCovariance invert_information(const Eigen::MatrixXd& schur);

}  // namespace rigproof::ml
