// bench_detection RUN: corners detected in a generated run against the projection of the true ones; and what a
// calibration of the intrinsics with OpenCV leaves of them, as it does with the pictures of real cameras, and how much
// of that the lens and the board leave in every picture.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <vector>

#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/error.h"
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

  void add(const BoardView& view, const TrueCamera& camera, const Truth& run, const Rigid3& T_camera_board) {
    double largest_here = 0.0;
    ++boards;
    for (const CornerObservation& corner : view.corners) {
      Vector2d truth;
      if (!camera.project(T_camera_board * run.corner(corner.id), &truth)) continue;
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

/// Corners of the views of one camera, as they were told to a calibration.
struct Views {
  std::vector<std::vector<cv::Point3f>> told;  ///< on the nominal board
  std::vector<std::vector<cv::Point2f>> seen,
      noiseless;  ///< detected; projected through the true lens from the true print

  void add(const BoardView& view, const TrueCamera& camera, const Truth& run, const Rigid3& T_camera_board) {
    told.emplace_back();
    seen.emplace_back();
    noiseless.emplace_back();
    for (const CornerObservation& corner : view.corners) {
      Vector2d truth;
      if (!camera.project(T_camera_board * run.corner(corner.id), &truth)) continue;
      const Eigen::Vector3f p = run.board.corner(corner.id).cast<float>();
      told.back().emplace_back(p.x(), p.y(), 0.0F);
      seen.back().emplace_back(static_cast<float>(corner.pixel.x()), static_cast<float>(corner.pixel.y()));
      noiseless.back().emplace_back(static_cast<float>(truth.x()), static_cast<float>(truth.y()));
    }
  }

  /// Residuals of corners after focal lengths, principal point and five coefficients were fitted to them [px].
  std::vector<cv::Point2f> residuals(const std::vector<std::vector<cv::Point2f>>& corners, const Camera& camera) const {
    cv::Mat K, distortion;
    std::vector<cv::Mat> turns, shifts;
    cv::calibrateCamera(told, corners, {camera.width_px, camera.height_px}, K, distortion, turns, shifts);
    std::vector<cv::Point2f> all;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      std::vector<cv::Point2f> projected;
      cv::projectPoints(told[i], turns[i], shifts[i], K, distortion, projected);
      for (std::size_t k = 0; k < projected.size(); ++k) all.push_back(corners[i][k] - projected[k]);
    }
    return all;
  }
};

double rms(const std::vector<cv::Point2f>& values) {
  double squares = 0.0;
  for (const cv::Point2f& v : values) squares += 0.5 * (v.x * v.x + v.y * v.y);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

// Root mean square of a coordinate after the refit, and the share of its square that is there without any noise.
void print_refit(const Views& views, const Camera& camera) {
  constexpr std::size_t kLeastViews = 6;
  if (camera.lens == Lens::kKannalaBrandt || views.told.size() < kLeastViews) return;
  const std::vector<cv::Point2f> seen = views.residuals(views.seen, camera),
                                 repeated = views.residuals(views.noiseless, camera);
  std::vector<cv::Point2f> noise;
  for (std::size_t i = 0; i < seen.size(); ++i) noise.push_back(seen[i] - repeated[i]);
  std::printf("%-8s after a refit of the intrinsics %.4f px, %.0f %% of its square repeats\n", "", rms(seen),
              100.0 * (1.0 - std::pow(rms(noise) / rms(seen), 2)));
}

void compare(const RunFolder& run) {
  const Truth truth = load_truth(run.truth_file());
  ObserveOptions options;
  options.use_depth = false;
  const Observations seen = observe(load_recording(run.recording()), options);
  if (truth.boards() > 1) throw Error(run.truth_file().string() + ": more_boards: this looks at runs with one board");
  for (std::size_t k = 0; k < truth.cameras.size(); ++k) {
    const TrueCamera& camera = truth.cameras[k];
    const auto T_camera_board = [&](const TrueStop& stop) {
      return (stop.T_world_robot * camera.T_robot_camera).inverse() * truth.T_world_board;
    };
    int visible = 0;
    for (const TrueStop& stop : truth.stops) visible += whole_in_view(camera.camera, truth.board, T_camera_board(stop));
    Statistics s;
    Views views;
    for (const BoardView& view : seen.board_views) {
      if (view.camera != static_cast<int>(k)) continue;
      const TrueStop& stop =
          *std::min_element(truth.stops.begin(), truth.stops.end(), [&](const auto& a, const auto& b) {
            return std::abs(a.stamp_s - view.stamp_s) < std::abs(b.stamp_s - view.stamp_s);
          });
      s.add(view, camera, truth, T_camera_board(stop));
      views.add(view, camera, truth, T_camera_board(stop));
    }
    const Eigen::Array2d rms = (s.squares / s.corners).sqrt(), bias = s.sum / s.corners;
    std::printf(
        "%-8s found %d, wholly visible %d, wrong order %d; rms %.4f %.4f px, bias %+.4f %+.4f px, largest %.3f px\n",
        camera.name.c_str(), s.boards, visible, s.wrong_order, rms.x(), rms.y(), bias.x(), bias.y(), s.largest);
    print_refit(views, camera.camera);
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
