// What a previous result and new observations know about the same cameras.
#pragma once

#include <string>
#include <vector>

#include "comparison.h"
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

/// What the new observations tell: linearised near the previous poses, where one decides whether anything moved, and at
/// their own optimum, where something that did move by far has gone.
struct NewKnowledge {
  KnownPoses held;
  KnownPoses free;
};

/// Of the matched cameras. Odometry that contradicts the images does not count, which a note says. `reasons` says why
/// nothing could be told, as where images contradict each other: then every direction is free.
NewKnowledge new_knowledge(const KnownPoses& before, const Observations& observations, const MovedOptions& options,
                           std::vector<Finding>* reasons, std::vector<Finding>* notes);

}  // namespace rigproof::moved
