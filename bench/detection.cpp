// bench_detection RUN: corners detected in a generated run against the projection of the true ones.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/run_folder.h"
#include "rigproof/truth/truth.h"

namespace {

using namespace rigproof;
using Eigen::Vector2d;

bool whole_in_view(const Camera& camera, const Board& board, const Rigid3& T_camera_board) {
  for (const Eigen::Vector3d& p : board.outline()) {
    Vector2d pixel;
    if (!camera.project(T_camera_board * p, &pixel) || !camera.contains(pixel, 2.0)) return false;
  }
  return true;
}

struct Statistics {
  Eigen::Array2d sum = Eigen::Array2d::Zero(), squares = Eigen::Array2d::Zero();
  double largest = 0.0;
  int corners = 0, boards = 0, wrong_order = 0;

  void add(const BoardView& view, const Camera& camera, const Board& board, const Rigid3& T_camera_board) {
    double largest_here = 0.0;
    ++boards;
    for (const CornerObservation& corner : view.corners) {
      Vector2d truth;
      if (!camera.project(T_camera_board * board.corner(corner.id), &truth)) continue;
      const Vector2d error = corner.pixel - truth;
      largest_here = std::max(largest_here, error.norm());
      sum += error.array();
      squares += error.array().square();
      ++corners;
    }
    largest = std::max(largest, largest_here);
    wrong_order += largest_here > 2.0;
  }
};

void compare(const RunFolder& run) {
  const Truth truth = load_truth(run.truth_file());
  ObserveOptions options;
  options.use_depth = false;
  const Observations seen = observe(load_recording(run.recording()), options);
  for (std::size_t k = 0; k < truth.cameras.size(); ++k) {
    const TrueCamera& camera = truth.cameras[k];
    const auto T_camera_board = [&](const TrueStop& stop) {
      return (stop.T_world_robot * camera.T_robot_camera).inverse() * truth.T_world_board;
    };
    int visible = 0;
    for (const TrueStop& stop : truth.stops) visible += whole_in_view(camera.camera, truth.board, T_camera_board(stop));
    Statistics s;
    for (const BoardView& view : seen.board_views) {
      if (view.camera != static_cast<int>(k)) continue;
      const TrueStop& stop =
          *std::min_element(truth.stops.begin(), truth.stops.end(), [&](const auto& a, const auto& b) {
            return std::abs(a.stamp_s - view.stamp_s) < std::abs(b.stamp_s - view.stamp_s);
          });
      s.add(view, camera.camera, truth.board, T_camera_board(stop));
    }
    const Eigen::Array2d rms = (s.squares / s.corners).sqrt(), bias = s.sum / s.corners;
    std::printf(
        "%-8s found %d, wholly visible %d, wrong order %d; rms %.4f %.4f px, bias %+.4f %+.4f px, largest %.3f px\n",
        camera.name.c_str(), s.boards, visible, s.wrong_order, rms.x(), rms.y(), bias.x(), bias.y(), s.largest);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: bench_detection RUN\n");
    return 2;
  }
  try {
    compare(RunFolder{argv[1]});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
