// bench_detection_foreign [VIEWS]: boards in pictures as cameras and simulators of others make them, against OpenCV's
// findChessboardCornersSB and against the true corners.
#include <Eigen/LU>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "foreign_picture.h"
#include "rigproof/calib/vision/checkerboard.h"

namespace {

using namespace rigproof;
using Eigen::Vector2d;
using Clock = std::chrono::steady_clock;

struct Row {
  int views = 0, opencv = 0, ours = 0, missed = 0, lost = 0, corners = 0;
  double squares = 0.0, whitened = 0.0, largest = 0.0, seconds = 0.0;
  std::map<std::string, int> reasons;

  void add(const ForeignView& view, const ForeignPicture& kind, std::uint64_t seed) {
    const Image8 image = draw_foreign(view.camera, view.board, view.T_camera_board, kind, seed);
    const auto start = Clock::now();
    const BoardDetection detection = detect_checkerboard(image, view.board);
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    ++views;
    const bool found = opencv_finds(image, view.board);
    opencv += found;
    if (const auto* missing = std::get_if<BoardNotFound>(&detection)) {
      if (found) ++missed, ++reasons[missing->why.code];
      return;
    }
    ++ours;
    const std::vector<Vector2d> truth = true_corners(view.camera, view.board, view.T_camera_board, kind.picture);
    const auto& seen = std::get<std::vector<CornerObservation>>(detection);
    lost += static_cast<int>(truth.size() - seen.size());
    for (const CornerObservation& corner : seen) {
      const Vector2d error = corner.pixel - truth[static_cast<std::size_t>(corner.id)];
      squares += 0.5 * error.squaredNorm();
      whitened += 0.5 * error.dot(corner.covariance_px2.inverse() * error);
      largest = std::max(largest, error.norm());
      ++corners;
    }
  }

  void print(const std::string& name) const {
    std::printf("%-20s %3d %6d %6d %6d %5d  %7.4f %7.3f %7.3f %7.1f ", name.c_str(), views, opencv, ours, missed, lost,
                std::sqrt(squares / corners), std::sqrt(whitened / corners), largest, 1e3 * seconds / views);
    for (const auto& [code, count] : reasons) std::printf(" %s %d", code.c_str(), count);
    std::printf("\n");
    std::fflush(stdout);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const int views = argc > 1 ? std::atoi(argv[1]) : 40;
  std::printf("%-20s %3s %6s %6s %6s %5s  %7s %7s %7s %7s\n", "picture", "of", "OpenCV", "ours", "missed", "lost",
              "rms px", "whitened", "largest", "ms");
  for (const ForeignPicture& kind : foreign_pictures()) {
    Row row;
    for (int i = 0; i < views; ++i)
      row.add(foreign_view(static_cast<std::uint64_t>(i)), kind, static_cast<std::uint64_t>(i));
    row.print(kind.name);
  }
  return 0;
}
