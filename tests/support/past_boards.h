// Drives of geometric mode past more than one board.
#pragma once

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "rigproof/geometric/geometric.h"

namespace rigproof {

/// Takes what a camera saw of a board at a stop out, and its depth on it.
template <typename Where>
void forget_board(Observations* observations, const Where& where) {
  std::set<std::pair<int, int>> gone;
  std::vector<BoardView>& views = observations->board_views;
  for (const BoardView& view : views)
    if (where(view)) gone.insert({view.stop, view.camera});
  const auto is_gone = [&gone](const auto& seen) { return gone.count({seen.stop, seen.camera}) > 0; };
  views.erase(std::remove_if(views.begin(), views.end(), is_gone), views.end());
  std::vector<PlaneObservation>& planes = observations->board_planes;
  planes.erase(std::remove_if(planes.begin(), planes.end(), is_gone), planes.end());
}

/// The drive of a configuration, past further boards.
inline GeometricRun drawn_past_boards(const GeometricConfig& config, GeometricScene scene,
                                      const std::vector<GeometricBoard>& others) {
  scene.more_boards = others;
  return draw_geometric_run(config, scene);
}

/// The reference rig with its right camera turned to the right, where a second board stands: the first one's copy,
/// turned about the middle of the robot's places.
struct PastTwoBoards {
  GeometricConfig config;
  GeometricBoard second;

  explicit PastTwoBoards(std::uint64_t seed, int stops = 40) {
    config.seed = seed;
    config.stops = stops;
    config.rig.T_robot_camera[2] = to_the_right() * config.rig.T_robot_camera[2];
    config.rig.min_cameras_per_stop = 2;
    second.board = config.rig.board;
  }

  static Rigid3 to_the_right() { return planar_pose(0.0, 0.0, -1.3); }
  /// With `second` where it stands.
  GeometricScene scene() {
    const GeometricScene scene = draw_scene(config);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Rigid3& T : scene.T_world_robot)
      middle += T.translation / static_cast<double>(scene.T_world_robot.size());
    const Rigid3 T_world_middle = planar_pose(middle.x(), middle.y(), 0.0);
    second.T_world_board = T_world_middle * to_the_right() * T_world_middle.inverse() * scene.T_world_board;
    return scene;
  }
  GeometricRun drawn() {
    const GeometricScene at = scene();
    return drawn_past_boards(config, at, {second});
  }
};

/// The reference rig before two boards, of which each camera has one and the other in turn, and cameras at one stop
/// different ones.
inline GeometricRun drawn_past_boards_in_turn(const GeometricConfig& config) {
  const GeometricScene scene = draw_scene(config);
  const Eigen::Vector3d across = scene.T_world_board.rotation * Eigen::Vector3d::UnitX();
  GeometricBoard beside{config.rig.board, scene.T_world_board, {}};
  beside.T_world_board.translation += 0.3 * across + Eigen::Vector3d(0.0, 0.0, 0.08);
  beside.T_world_board.rotation = so3_exp({0.05, -0.04, 0.1}) * beside.T_world_board.rotation;
  GeometricRun run = draw_geometric_run(config, scene);
  Observations& all = run.observations;
  forget_board(&all, [](const BoardView& view) { return (view.stop + view.camera) % 2 == 1; });
  std::set<std::pair<int, int>> taken;
  for (const BoardView& view : all.board_views) taken.insert({view.stop, view.camera});
  Observations second = draw_geometric_run(config, {beside.T_world_board, scene.T_world_robot}).observations;
  forget_board(&second, [&taken](const BoardView& view) { return taken.count({view.stop, view.camera}) > 0; });
  for (BoardView& view : second.board_views) view.board = 1;
  all.more_boards.push_back(beside.board);
  run.truth.more_boards.push_back({beside.board, {}, beside.T_world_board});
  all.board_views.insert(all.board_views.end(), second.board_views.begin(), second.board_views.end());
  all.board_planes.insert(all.board_planes.end(), second.board_planes.begin(), second.board_planes.end());
  const auto by_place = [](const auto& a, const auto& b) {
    return std::tie(a.stop, a.camera) < std::tie(b.stop, b.camera);
  };
  std::sort(all.board_views.begin(), all.board_views.end(), by_place);
  std::sort(all.board_planes.begin(), all.board_planes.end(), by_place);
  return run;
}

}  // namespace rigproof
