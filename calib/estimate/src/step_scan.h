// Collects what scores of steps are made of while the normal equations are summed up.
#pragma once

#include <vector>

#include "local_block.h"
#include "rigproof/calib/estimate/arrow_system.h"
#include "rigproof/calib/estimate/state.h"
#include "rigproof/calib/estimate/step_scores.h"

namespace rigproof::ml {

class StepScan : public BlockSink {
 public:
  /// @param splits ascending, of stops 1 and later
  StepScan(const Layout& layout, std::vector<int> splits);

  /// Blocks by Weighting::kInformation.
  void add(const LocalBlock& block) override;
  /// @param globals covariance of the globals
  std::vector<StepScore> scores(const State& state, const EliminatedSystem& eliminated,
                                const Eigen::MatrixXd& globals) const;

 private:
  // What the blocks between two splits say about a body's pose, and of its coupling to all globals.
  struct Part {
    Matrix6d information = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    Eigen::Matrix<double, Eigen::Dynamic, 6> globals;
    int views = 0;
  };
  struct Body {
    std::vector<Matrix6d> poses;  // coupling to each stop's pose
    std::vector<Part> parts;      // from each split on to the next; the first are before any
    bool has_step = false;
  };

  std::size_t place_of(int body) const;
  std::size_t part_of(int stop) const;
  void add(const LocalBlock& block, std::size_t segment, int stop, Body* body);
  Body all_cameras(const State& state) const;
  // Of a body's gradient what is left where all other unknowns take their own step.
  struct Solution {
    const EliminatedSystem& eliminated;
    const Eigen::MatrixXd& covariance;  // of the globals
    Eigen::MatrixXd response;
    Eigen::VectorXd globals, poses;  // their step
  };
  void score(const Body& body, const std::vector<int>& bodies, const Solution& at,
             std::vector<StepScore>* scores) const;

  const Layout& layout_;
  std::vector<int> splits_;
  std::vector<Body> bodies_;  // cameras, then boards
};

}  // namespace rigproof::ml
