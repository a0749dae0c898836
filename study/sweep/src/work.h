// The work of a sweep's processes: make and search pictures, assemble observations, solve, judge.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "answer.h"
#include "cache.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/vision/feature_source.h"
#include "rigproof/calib/vision/horizon_source.h"
#include "rigproof/core/error.h"
#include "rigproof/study/sweep/sweep.h"
#include "rigproof/validate/bound.h"

namespace rigproof {

/// Adds to a counter of SweepCounters.
using Count = std::function<void(const std::string& name, std::uint64_t more)>;

struct PictureWork {
  const SweepCache* cache = nullptr;
  int jobs = 1;
  int device = -2;
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< images
  std::function<bool()> keep_going;                                   ///< false interrupts
  Count count;
};

/// Generates a set's pictures, or what is missing of them, and looks for boards and planes in each. A configuration
/// that leaves nothing to render is no error here: its tasks will say so. Throws Error on anything else.
void make_pictures(const PictureSet& set, bool with_images, const PictureWork& work);

/// What the methods of a task are given.
struct TaskData {
  Observations observations;
  std::optional<Recording> recording;
  Truth truth;
  std::vector<TransformBound> bounds;
  double seconds = 0.0;
  std::string gl_renderer;                   ///< that drew the recording's images
  std::shared_ptr<CachedFindings> findings;  ///< in the recording's images; none in geometric mode
  std::function<bool()> keep_going;          ///< false interrupts whatever looks at them
};

/// Throws Error that says why the task has nothing to calibrate from, MachineError where that is nobody's fault, and
/// Error with ExitCode::kTryAgain if `keep_going` says no.
TaskData data_of(const SweepConfig& config, const SweepTask& task, const SweepCache& cache, const Count& count,
                 const std::function<bool()>& keep_going);

/// What looks at images as a SweepVision says. Throws Error where a network is none.
struct SweepSight {
  explicit SweepSight(const SweepVision& vision);
  std::unique_ptr<FeatureSource> features;  ///< none: SIFT
  std::unique_ptr<HorizonSource> horizon;
};

/// The same task with the ground from where it is wanted, and the bound of that; unchanged where there are no images.
/// Throws Error with ExitCode::kTryAgain where it is interrupted, as does answer_of().
TaskData with_ground(const TaskData& data, const std::string& ground, const SweepSight& sight);

/// A method's answer to a task, judged.
SweepAnswer answer_of(const Method& method, const TaskData& data, const SweepSight& sight);
/// That of a method that cannot be run.
SweepAnswer could_not_run(const Finding& reason, const TaskData& data);
/// Where there was nothing to judge.
SweepAnswer failed_answer(const Finding& reason);

/// The rows of a result, without what the task says of itself.
std::vector<SweepRow> rows_of(const Result& result, SweepStatus status, const TaskData& data);

}  // namespace rigproof
