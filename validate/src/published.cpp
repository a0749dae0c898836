#include "rigproof/validate/published.h"

#include <cmath>

#include "rigproof/core/figures.h"
#include "rigproof/validate/body_angles.h"

namespace rigproof {

const std::vector<PublishedTable>& published_tables() {
  const std::optional<double> none;
  static const std::vector<PublishedTable> tables = {
      {"camera to robot, synthetic",
       false,
       true,
       {{"MEMROC", {0.61, 0.25, 0.15, 0.08, 0.13, 0.16}},
        {"Joint-MEMROC", {0.66, 0.16, 0.14, 0.14, 0.14, 0.15}},
        {"RobotAutocalib", {0.92, 0.79, 0.92, 1.87, 1.32, 1.84}},
        {"SensorX2Car", {none, none, none, 0.26, 0.82, 1.22}}}},
      {"camera to camera, synthetic",
       true,
       true,
       {{"MEMROC", {0.42, 0.23, 0.87, 0.11, 0.18, 0.15}},
        {"Joint-MEMROC", {0.20, 0.25, 0.78, 0.22, 0.23, 0.14}},
        {"RobotAutocalib", {2.58, 4.99, 3.72, 2.52, 3.09, 1.68}},
        {"SensorX2Car", {none, none, none, 0.44, 0.21, 2.40}},
        {"Li et al.", {0.26, 0.27, 0.34, 0.12, 0.14, 0.17}}}},
      {"camera to camera, real robot",
       true,
       false,
       {{"MEMROC", {1.97, 1.15, 0.34, 0.79, 1.02, 0.72}},
        {"Joint-MEMROC", {0.48, 0.56, 0.33, 0.74, 0.83, 0.66}},
        {"RobotAutocalib", {2.41, 4.42, 2.43, 3.83, 4.82, 4.22}},
        {"SensorX2Car", {none, none, none, 2.95, 1.99, 2.75}}}},
  };
  return tables;
}

std::optional<std::array<double, 6>> mean_absolute_error(const std::vector<TransformError>& errors,
                                                         bool as_roll_pitch_yaw) {
  if (errors.empty()) return std::nullopt;
  Vector6d sum = Vector6d::Zero();
  for (const TransformError& error : errors) {
    Vector6d e = error.error;
    if (as_roll_pitch_yaw) e.tail<3>() = roll_pitch_yaw_error(error.T_estimate, error.T_true, error.between_cameras);
    sum += e.cwiseAbs();
  }
  std::array<double, 6> mean{};
  for (std::size_t i = 0; i < 6; ++i)
    mean[i] = in_unit(sum[static_cast<Eigen::Index>(i)] / static_cast<double>(errors.size()), i);
  return mean;
}

}  // namespace rigproof
