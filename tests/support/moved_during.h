// Drives during which something is knocked: from a stop on everything is as in a second run in which it sits elsewhere.
#pragma once

#include <algorithm>
#include <vector>

#include "rigproof/geometric/geometric.h"

namespace rigproof {

/// From stop `split` on, what these cameras see is taken from the other run, in which they sit elsewhere.
inline void take_from(const Observations& other, int split, const std::vector<int>& cameras, Observations* into) {
  const auto replace = [&](auto Observations::*list) {
    auto& items = into->*list;
    const auto is_replaced = [&](const auto& item) {
      return item.stop >= split && std::find(cameras.begin(), cameras.end(), item.camera) != cameras.end();
    };
    items.erase(std::remove_if(items.begin(), items.end(), is_replaced), items.end());
    std::copy_if((other.*list).begin(), (other.*list).end(), std::back_inserter(items), is_replaced);
    std::stable_sort(items.begin(), items.end(), [](const auto& a, const auto& b) {
      return a.stop != b.stop ? a.stop < b.stop : a.camera < b.camera;
    });
  };
  replace(&Observations::board_views);
  replace(&Observations::ground_planes);
  replace(&Observations::board_planes);
}

/// @param change of each of the cameras, in the chart of transform_error()
inline GeometricRun draw_moved_during(const GeometricConfig& config, int split, const std::vector<int>& cameras,
                                      const Vector6d& change) {
  const GeometricScene scene = draw_scene(config);
  GeometricRun run = draw_geometric_run(config, scene);
  GeometricConfig moved = config;
  for (const int c : cameras) {
    Rigid3& T = moved.rig.T_robot_camera[static_cast<std::size_t>(c)];
    T = apply_transform_error(T, change);
  }
  take_from(draw_geometric_run(moved, scene).observations, split, cameras, &run.observations);
  return run;
}

/// The same with the board elsewhere.
inline GeometricRun draw_board_moved_during(const GeometricConfig& config, int split, const Vector6d& change) {
  GeometricScene scene = draw_scene(config);
  GeometricRun run = draw_geometric_run(config, scene);
  scene.T_world_board = apply_transform_error(scene.T_world_board, change);
  std::vector<int> all;
  for (std::size_t c = 0; c < config.rig.cameras.size(); ++c) all.push_back(static_cast<int>(c));
  take_from(draw_geometric_run(config, scene).observations, split, all, &run.observations);
  return run;
}

}  // namespace rigproof
