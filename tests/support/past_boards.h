// Drives of geometric mode past more than one board.
#pragma once

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "rigproof/geometric/geometric.h"

namespace rigproof {

struct OtherBoard {
  Board board;
  Rigid3 T_world_board;
  std::vector<Eigen::Vector3d> print_errors_m;  ///< of each corner, true minus stated; empty: none
};

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

/// The drive of a configuration, past further boards. Of a camera at a stop the view of the first board counts that it
/// sees.
/// @param in_turn where the number of stop and camera is odd, the first one does not count
inline GeometricRun drawn_past_boards(const GeometricConfig& config, const GeometricScene& scene,
                                      const std::vector<OtherBoard>& others, bool in_turn = false) {
  GeometricRun run = draw_geometric_run(config, scene);
  Observations& all = run.observations;
  if (in_turn) forget_board(&all, [](const BoardView& view) { return (view.stop + view.camera) % 2 == 1; });
  std::set<std::pair<int, int>> taken;
  for (const BoardView& view : all.board_views) taken.insert({view.stop, view.camera});
  for (const OtherBoard& other : others) {
    GeometricConfig its_config = config;
    its_config.rig.board = other.board;
    its_config.rig.print_errors_m = other.print_errors_m;
    const Observations seen = draw_geometric_run(its_config, {other.T_world_board, scene.T_world_robot}).observations;
    all.more_boards.push_back(other.board);
    std::set<std::pair<int, int>> own;
    for (BoardView view : seen.board_views) {
      if (taken.count({view.stop, view.camera}) > 0) continue;
      own.insert({view.stop, view.camera});
      view.board = static_cast<int>(all.more_boards.size());
      all.board_views.push_back(view);
    }
    for (const PlaneObservation& plane : seen.board_planes)
      if (own.count({plane.stop, plane.camera}) > 0) all.board_planes.push_back(plane);
    taken.insert(own.begin(), own.end());
  }
  const auto by_place = [](const auto& a, const auto& b) {
    return std::tie(a.stop, a.camera) < std::tie(b.stop, b.camera);
  };
  std::sort(all.board_views.begin(), all.board_views.end(), by_place);
  std::sort(all.board_planes.begin(), all.board_planes.end(), by_place);
  return run;
}

/// The reference rig with its right camera turned to the right, where a second board stands: the first one's copy,
/// turned about the middle of the robot's places.
struct PastTwoBoards {
  GeometricConfig config;
  OtherBoard second;

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
  OtherBoard beside{config.rig.board, scene.T_world_board, {}};
  beside.T_world_board.translation += 0.3 * across + Eigen::Vector3d(0.0, 0.0, 0.08);
  beside.T_world_board.rotation = so3_exp({0.05, -0.04, 0.1}) * beside.T_world_board.rotation;
  return drawn_past_boards(config, scene, {beside}, true);
}

}  // namespace rigproof
