// Which places to go to: those that tell most, and of equals the near ones.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <set>
#include <vector>

#include "outlook.h"

namespace rigproof::suggest {

/// Candidates by number.
struct Choice {
  std::vector<std::size_t> places;
  std::set<std::size_t> given_up = {};  ///< that no command leads to
  double score = std::numeric_limits<double>::infinity();
  bool nothing_helps = false;  ///< no further place makes a sigma that matters smaller by what is worth a stop

  bool may_take(std::size_t candidate) const;
  Choice without(std::size_t candidate) const;
};

/// A metre of driving costs as much as a radian of turning; a blocked way is only taken if there is no other.
double cost_between(const Outlook& outlook, const Place& from, const Place& to);

/// Chooses among candidates by what they would tell.
class Chooser {
 public:
  /// @param stated what the method states now, of the cameras that saw the board: what the forecast does not hold of it
  /// is taken to shrink as the rest does
  /// @param first stops that come before, whatever is chosen
  Chooser(const Outlook& outlook, const AcceptLimits& limits, const std::vector<AxisSigmas>& stated,
          const std::vector<Place>& places, const std::vector<Place>& first);

  /// With as many places as are wanted and help, each the next best one, then exchanged.
  Choice completed(Choice choice) const;

 private:
  std::vector<const StopInformation*> stops_of(const std::vector<std::size_t>& chosen) const;
  double score(const std::vector<std::size_t>& chosen) const;
  bool improve(std::size_t position, Choice* choice) const;
  std::vector<bool> axes_that_matter() const;

  const Outlook& outlook_;
  const std::vector<Place>& places_;
  std::size_t wanted_ = 0;
  std::vector<StopInformation> first_, information_;
  std::vector<double> cost_;   // of going there at once
  Eigen::VectorXd weight_;     // of all axes of all cameras that saw the board: in units of the limits
  std::vector<bool> matters_;  // likewise
};

}  // namespace rigproof::suggest
