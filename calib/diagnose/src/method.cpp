#include "rigproof/calib/diagnose/method.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace rigproof {
namespace {

// What is known of it is known as numbers, within what a result's file may hold.
bool is_in_numbers(const EstimatedTransform& transform) {
  constexpr double kFarthestM = 1e6;
  const Rigid3& T = transform.T_parent_child;
  if (!T.translation.allFinite() || T.translation.cwiseAbs().maxCoeff() > kFarthestM) return false;
  if (!T.rotation.coeffs().allFinite()) return false;
  for (Eigen::Index i = 0; i < 6; ++i)
    if (transform.covariance && transform.observable[static_cast<std::size_t>(i)] &&
        !std::isfinite((*transform.covariance)(i, i)))
      return false;
  return true;
}

// A method that ran away has answered nothing.
void refuse_what_is_no_number(Result* result) {
  std::vector<Finding> reasons;
  for (auto* list : {&result->camera_to_robot, &result->camera_to_camera}) {
    const auto bad = std::stable_partition(list->begin(), list->end(), is_in_numbers);
    for (auto transform = bad; transform != list->end(); ++transform)
      reasons.push_back(list == &result->camera_to_robot
                            ? Finding("pose.open").of(transform->child)
                            : Finding("pair.open").of({transform->child, transform->parent}));
    list->erase(bad, list->end());
  }
  if (reasons.empty()) return;
  result->reasons.insert(result->reasons.end(), reasons.begin(), reasons.end());
  result->joint_covariance.reset();
  result->lasting.reset();
  const bool any = !result->camera_to_robot.empty() || !result->camera_to_camera.empty();
  result->status = any ? ResultStatus::kPartial : ResultStatus::kRefused;
}

}  // namespace

std::optional<Finding> Method::why_not(const MethodInput& /*input*/) const { return std::nullopt; }

Result Method::solve_recording(const MethodInput& input) const { return solve(input.observations); }

std::optional<Finding> refusal_of(const Method& method, const MethodInput& input) {
  const int boards = input.observations.boards();
  if (boards > 1 && !method.traits().several_boards) return Finding("method.one_board", {{"boards", boards}});
  return method.why_not(input);
}

Result run_method(const Method& method, const MethodInput& input) {
  Result result;
  const std::optional<Finding> reason = refusal_of(method, input);
  const auto start = std::chrono::steady_clock::now();
  if (reason)
    result.reasons = {*reason};
  else
    result = method.solve_recording(input);
  refuse_what_is_no_number(&result);
  result.method = method.traits().name;
  result.rotation_centre_m = input.observations.odometry_noise.rotation_centre_m;
  result.rotation_centre_sigma_m = input.observations.odometry_noise.rotation_centre_sigma_m;
  result.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace rigproof
