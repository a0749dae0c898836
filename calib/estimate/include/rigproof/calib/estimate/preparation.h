// Input of a solution: usable observations, board poses of the views, the motion and an initial guess.
#pragma once

#include <memory>
#include <vector>

#include "rigproof/calib/estimate/ml_options.h"
#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/estimate/repeating_errors.h"
#include "rigproof/calib/estimate/state.h"
#include "rigproof/calib/estimate/whitened.h"
#include "rigproof/calib/geometry/initial_guess.h"
#include "rigproof/calib/geometry/trajectory_alignment.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

/// Problems refer to its observations, which must therefore stay where they are.
struct Preparation {
  Preparation(const Observations& observations, const MlOptions& ml_options)
      : original(observations), options(ml_options), used(observations) {}

  const Observations& original;
  const MlOptions& options;
  /// Without planes that are not the ground, without errors that repeat in every image, and, until the rest is known
  /// to be in order, without the places that are stated of boards.
  Observations used;
  std::vector<ViewPose> views;
  std::vector<Exclusion> excluded;
  TrajectoryAlignment alignment;
  InitialGuess guess;
  State start;
  std::size_t rejected_planes = 0;
  Priors priors;
  std::shared_ptr<const Whitened> whitened;  ///< what is used
  RemovedErrors repeating;  ///< errors that repeat in every image, and what was taken out of the corners

  /// False: no camera saw the board, there is nothing to solve.
  bool solvable() const { return guess.T_world_board.has_value(); }
  bool has_pose(std::size_t view) const;
  /// Whether any view has a pose of the board.
  bool sees(int board) const;
  bool solved(int camera) const { return guess.T_robot_camera[static_cast<std::size_t>(camera)].has_value(); }
  std::vector<int> solved_cameras() const;
  /// A number for each camera, equal for cameras that are connected: by two stops at which both see one board, or by a
  /// chain of such pairs. A single stop could not outweigh a whole drive that is wrong.
  /// @param left_out views that do not count, by index into the board's views
  std::vector<int> seen_together(const std::vector<bool>& left_out) const;
  /// A number for each camera, equal for cameras that see the same board, whenever, or are joined by a chain of such:
  /// what the motion of one tells holds for the others.
  std::vector<int> tied_by_boards() const;
  /// Those of the options; the error that all heights share by the share of the stops at which the robot moves.
  PriorSigmas sigmas() const;
};

/// As far as closed forms tell, which takes a small share of what a solution takes; complete() makes it ready for one.
/// @param views what the same views gave before; null: they are looked at
Preparation closed_form(const Observations& observations, const MlOptions& options,
                        const std::vector<ViewPose>* views = nullptr);
Preparation closed_form(const Observations&& observations, const MlOptions& options,
                        const std::vector<ViewPose>* views = nullptr) = delete;
void complete(Preparation* prepared);

/// Both, one after the other.
Preparation prepare(const Observations& observations, const MlOptions& options,
                    const std::vector<ViewPose>* views = nullptr);
/// Neither may be a temporary: the preparation refers to both.
Preparation prepare(const Observations&& observations, const MlOptions& options,
                    const std::vector<ViewPose>* views = nullptr) = delete;
Preparation prepare(const Observations& observations, const MlOptions&& options,
                    const std::vector<ViewPose>* views = nullptr) = delete;

}  // namespace rigproof::ml
