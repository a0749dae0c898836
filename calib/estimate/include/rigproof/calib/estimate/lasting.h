// Errors of lenses, board and depth that another drive of the same robot meets again: where they stand among the
// unknowns of a problem.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rigproof/calib/estimate/state.h"
#include "rigproof/calib/estimate/unknowns.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/result.h"

namespace rigproof::ml {

struct LastingUnknown {
  LastingErrors::Owner of;
  std::string name;     ///< with its unit
  int place;            ///< among the globals
  double units_per_si;  ///< what the name says = this * the global
  double stated_sigma;  ///< of the global, before any data
  double drift;         ///< by how much it is another one the next day, one sigma; at most what is stated
};

/// All that are not believed.
std::vector<LastingUnknown> lasting_unknowns(const Observations& observations, const Priors& priors);

/// The values of all that last, where they stand among the globals; zero elsewhere.
Eigen::VectorXd lasting_among_globals(const State& state, const Layout& layout);

/// Of each camera and board: their errors mean nothing beside anything else than what is stated.
std::vector<LastingErrors::Stated> hashes_of_stated(const Observations& observations);

}  // namespace rigproof::ml
