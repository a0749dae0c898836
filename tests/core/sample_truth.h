// A small truth for tests.
#pragma once

#include "random_values.h"
#include "rigproof/truth/truth.h"

namespace rigproof {

inline Truth sample_truth() {
  RandomStream random(5, "sample truth");
  Truth truth;
  truth.scene = "indoor_lab";
  truth.seed = 0xFFFFFFFFFFFFFFFFULL;
  truth.T_world_board = random_transform(random);
  truth.cameras = {
      {"left", random_transform(random), random_camera(random, Lens::kBrownConrady), 1.0021, {{"jpeg_quality", 90.0}}},
      {"center", random_transform(random), random_camera(random, Lens::kKannalaBrandt), std::nullopt, {}}};
  for (int i = 0; i < 3; ++i) truth.stops.push_back({i + random.uniform(), random_transform(random)});
  truth.odometry_noise = {OdometryModel::kPerPose, 0.002, 0.01};
  truth.odometry_scale = 1.0123;
  truth.odometry_yaw_factor = 0.987;
  truth.drawn = {{"board.bow_mm", -1.25}, {"drive.payload_kg", 12.5}};
  return truth;
}

}  // namespace rigproof
