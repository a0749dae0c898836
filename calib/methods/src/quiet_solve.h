// Ceres without a word: its own log on standard error is no message to a user.
#pragma once

#include <ceres/solver.h>
#include <glog/logging.h>

namespace rigproof {

inline ceres::Solver::Summary quiet_solve(ceres::Solver::Options options, ceres::Problem* problem) {
  FLAGS_minloglevel = google::GLOG_FATAL;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem, &summary);
  return summary;
}

}  // namespace rigproof
