// What a previous result and new observations know about the same cameras.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "comparison.h"
#include "rigproof/calib/diagnose/ml.h"
#include "rigproof/calib/estimate/noise.h"
#include "rigproof/calib/plan/moved.h"

namespace rigproof::moved {

/// The cameras of the previous result, in its order: those that see the board now, and those that do not.
struct Match {
  std::vector<std::string> names;
  std::vector<int> observed;  ///< of names: index into Observations::cameras
  std::vector<std::string> unseen;
};
/// Throws Error if the observations know none of the previous result's cameras.
Match match_cameras(const Result& previous, const Observations& observations);

/// What the matched cameras saw, they alone and in the match's order.
Observations of_matched(const Observations& observations, const Match& match);

/// Poses and covariances of the previous result. Where it knows only camera to camera, the rig's place on the robot is
/// free. Correlations that it does not tell are allowed for by larger covariances.
/// Throws Error if it states no uncertainty.
KnownPoses previous_knowledge(const Result& previous, const Observations& observations, const Match& match,
                              std::vector<Finding>* notes);

/// What the new observations tell.
class NewKnowledge {
 public:
  /// Nothing: every direction is free.
  explicit NewKnowledge(const KnownPoses& before);
  /// `used`: without what repeats in every image.
  NewKnowledge(const KnownPoses& before, Observations used, const MlEstimate& estimate, const CalibrationNoise& noise);

  /// Linearised near the previous poses, but for the columns of `moved`, along which the cameras may have moved by far;
  /// where the equations cannot be solved so, at the observations' own optimum.
  KnownPoses if_moved(const Eigen::MatrixXd& moved) const;

  /// The same, were the errors that last of some cameras or boards other ones than then; absent where the previous
  /// result tells nothing of these.
  std::optional<NewKnowledge> with_others(const std::function<bool(const LastingErrors::Owner&)>& changed) const;

 private:
  KnownPoses before_, free_;
  Observations used_;
  CalibrationState optimum_;
  CalibrationNoise noise_;
  std::shared_ptr<const ml::RemovedErrors> repeating_;  ///< out of what is used
};

/// Of the matched cameras. Odometry that contradicts the images does not count, which a note says. `reasons` says why
/// nothing could be told, as where images contradict each other: then every direction is free.
NewKnowledge new_knowledge(const KnownPoses& before, const Observations& observations, const MovedOptions& options,
                           std::vector<Finding>* reasons, std::vector<Finding>* notes);

}  // namespace rigproof::moved
