// A bag as a recording that is about to be written: who is who, and which pictures to keep.
#pragma once

#include <string>
#include <vector>

#include "bag_survey.h"
#include "frame_choice.h"
#include "rigproof/core/recording.h"
#include "rigproof/study/import/init.h"
#include "topic_choice.h"

namespace rigproof {

/// A picture of the source and the files of the recording that it becomes.
struct PlannedPicture {
  std::size_t camera = 0;
  std::size_t frame = 0;  ///< index into Recording::frames[camera]
  bool is_depth = false;
  BagPlace place;
};

struct ImportPlan {
  Recording recording;  ///< its files have names without an extension until they are written
  std::vector<PlannedPicture> pictures;
  std::vector<const ImageTopic*> images, depth;  ///< [camera]; depth null where there is none
  std::vector<std::vector<double>> to_undo;      ///< [camera] of its images, as InfoReading says; empty: nothing
  InitReport report;
};

/// Whether the robot's static frames are taken from the bag: not with tf_static=none.
bool takes_frames(const InitOptions& options);

/// Throws Error with every problem.
ImportPlan plan_import(const BagSurvey& survey, const InitOptions& options);

}  // namespace rigproof
