#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/text.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/validate/body_angles.h"
#include "rigproof/validate/validate.h"
#include "work.h"

namespace rigproof {
namespace {

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

SweepStatus status_of(ResultStatus status) {
  return status == ResultStatus::kSolved    ? SweepStatus::kSolved
         : status == ResultStatus::kPartial ? SweepStatus::kPartial
                                            : SweepStatus::kRefused;
}

const TransformError* error_of(const std::vector<TransformError>& errors, const std::string& parent,
                               const std::string& child) {
  const auto found = std::find_if(errors.begin(), errors.end(), [&](const TransformError& error) {
    return error.child == child && (parent.empty() || error.parent == parent);
  });
  return found == errors.end() ? nullptr : &*found;
}

void add_bound(const TaskData& data, const std::string& parent, const std::string& child, SweepRow* row) {
  for (const TransformBound& bound : data.bounds) {
    if (bound.child != child || bound.parent != parent) continue;
    for (std::size_t axis = 0; axis < 6; ++axis)
      if (bound.sigma[axis]) row->bound[axis] = in_unit(*bound.sigma[axis], axis);
  }
}

void add_error(const TransformError& error, SweepRow* row) {
  row->status = error.fully_observable() ? SweepStatus::kSolved : SweepStatus::kPartial;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!error.observable[axis]) continue;
    const auto i = static_cast<Eigen::Index>(axis);
    row->error[axis] = in_unit(error.error[i], axis);
    if (error.sigma) row->sigma[axis] = in_unit((*error.sigma)[i], axis);
  }
  if (!error.observable[3] || !error.observable[4] || !error.observable[5]) return;
  const Eigen::Vector3d angles = roll_pitch_yaw_error(error.T_estimate, error.T_true, error.between_cameras);
  for (std::size_t i = 0; i < 3; ++i) row->roll_pitch_yaw[i] = rad_to_deg(angles[static_cast<Eigen::Index>(i)]);
}

// Where methods of consecutive views find the camera's motions.
int motions_of(const Observations& observations, std::size_t camera) {
  std::set<int> stops;
  for (const BoardView& view : observations.board_views)
    if (view.camera == static_cast<int>(camera)) stops.insert(view.stop);
  return static_cast<int>(
      std::count_if(stops.begin(), stops.end(), [&](int stop) { return stops.count(stop + 1) > 0; }));
}

Finding finding_of(const Error& error) {
  const auto* finding = dynamic_cast<const FindingError*>(&error);
  return finding == nullptr ? stated(error.what(), Severity::kRefusal) : finding->finding();
}

// Of the whole rig, from which rows of its parts are made.
SweepRow rig_row(SweepStatus status, const std::vector<Finding>& reasons) {
  SweepRow row;
  row.camera = "all";
  row.status = status;
  row.reasons = reasons;
  return row;
}

SweepRow subject_row(SweepSubject subject, const std::string& camera, const SweepRow& rig) {
  SweepRow row = rig;
  row.subject = subject;
  row.camera = camera;
  if (rig.status == SweepStatus::kSolved || rig.status == SweepStatus::kPartial) row.status = SweepStatus::kNotGiven;
  return row;
}

}  // namespace

std::vector<SweepRow> rows_of(const Result& result, SweepStatus status, const TaskData& data) {
  const Comparison comparison = compare(result, data.truth);
  const SweepRow rig = rig_row(status, result.reasons);
  std::vector<SweepRow> rows = {rig};
  rows.front().nees = comparison.nees;
  rows.front().nees_degrees_of_freedom = comparison.nees_degrees_of_freedom;
  std::vector<int> motions;
  for (const TrueCamera& camera : data.truth.cameras) {
    SweepRow row = subject_row(SweepSubject::kCamera, camera.name, rig);
    motions.push_back(motions_of(data.observations, motions.size()));
    row.motions = motions.back();
    add_bound(data, "robot", camera.name, &row);
    if (const TransformError* error = error_of(comparison.camera_to_robot, "", camera.name)) add_error(*error, &row);
    for (const CameraNees& nees : comparison.camera_nees) {
      if (nees.camera != camera.name) continue;
      row.nees = nees.nees;
      row.nees_degrees_of_freedom = nees.degrees_of_freedom;
    }
    rows.push_back(std::move(row));
  }
  for (std::size_t j = 0; j < data.truth.cameras.size(); ++j) {
    for (std::size_t k = j + 1; k < data.truth.cameras.size(); ++k) {
      const std::string &parent = data.truth.cameras[j].name, &child = data.truth.cameras[k].name;
      SweepRow row = subject_row(SweepSubject::kPair, parent + "-" + child, rig);
      row.motions = std::min(motions[j], motions[k]);
      add_bound(data, parent, child, &row);
      if (const TransformError* error = error_of(comparison.camera_to_camera, parent, child)) add_error(*error, &row);
      rows.push_back(std::move(row));
    }
  }
  for (SweepRow& row : rows)
    if (row.status == SweepStatus::kSolved) row.reasons.clear();
  return rows;
}

SweepAnswer failed_answer(const Finding& reason) {
  SweepAnswer answer;
  answer.rows = {rig_row(SweepStatus::kFailed, {reason})};
  return answer;
}

SweepAnswer could_not_run(const Finding& reason, const TaskData& data) {
  Result nothing;
  nothing.reasons = {reason};
  SweepAnswer answer;
  answer.rows = rows_of(nothing, SweepStatus::kCouldNotRun, data);
  return answer;
}

SweepAnswer answer_of(const Method& method, const TaskData& data, const SweepSight& sight) {
  MethodInput input{data.observations, data.recording ? &*data.recording : nullptr, 1, sight.features.get(),
                    sight.horizon.get()};
  input.memory = data.findings.get();
  input.keep_going = data.keep_going;
  SweepAnswer answer;
  Result nothing;
  const std::optional<Finding> why_not = refusal_of(method, input);
  const auto start = std::chrono::steady_clock::now();
  const double cpu_start = cpu_seconds();
  try {
    if (why_not) {
      answer.rows = could_not_run(*why_not, data).rows;
    } else {
      const Result result = method.solve_recording(input);
      answer.times.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      answer.rows = rows_of(result, program_broke(result) ? SweepStatus::kFailed : status_of(result.status), data);
    }
  } catch (const Error& error) {
    if (error.exit_code() == ExitCode::kTryAgain) throw;
    nothing.reasons = {finding_of(error)};
    answer.rows = rows_of(nothing, SweepStatus::kFailed, data);
  } catch (const std::exception& error) {
    nothing.reasons = {Finding("method.threw", {{"text", error.what()}})};
    answer.rows = rows_of(nothing, SweepStatus::kFailed, data);
  }
  if (answer.times.solve_s == 0.0 && !why_not)
    answer.times.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  answer.times.cpu_s = cpu_seconds() - cpu_start;
  answer.times.observe_s = data.seconds;
  return answer;
}

}  // namespace rigproof
