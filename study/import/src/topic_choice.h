// Which topics are the cameras, their depth and the odometry: guessed from types and names, or as the user says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bag_survey.h"

namespace rigproof {

struct CameraTopics {
  std::string name;
  std::string images;
  std::string camera_info;  ///< topic; empty: there is none
  std::string depth;        ///< topic; empty: none
  bool depth_is_given = false;
  bool is_given = false;  ///< by a rule
};

struct TopicChoice {
  std::vector<CameraTopics> cameras;
  const PoseTopic* odometry = nullptr;
  std::vector<std::string> notes;  ///< image topics that are not taken
};

/// What a user says of a topic: "left.depth=/a/b".
struct TopicRule {
  std::string name;   ///< "left" or "odometry"
  std::string part;   ///< "", "depth" or "camera_info"
  std::string topic;  ///< "none": leave it out
};
/// Throws Error with every rule that cannot be read.
std::vector<TopicRule> topic_rules(const std::vector<std::string>& texts);

/// Throws Error with every problem: nothing found, several that it could be, topics that are not in the bag, two
/// cameras with the same topic.
TopicChoice choose_topics(const BagSurvey& survey, const std::vector<TopicRule>& rules);

}  // namespace rigproof
