// bench_charuco [VIEWS] [SEED] [charuco|aprilgrid] [FARTHEST_M]: boards with markers up to 4 m (AprilGrids 2 m) away
// and 60 degrees oblique, by kind of picture: how many are missed or wrongly identified, how accurate their corners
// are, and how far poses err against the bound of these corners. Half hidden ones have the noise, too.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "charuco_views.h"

namespace {

using namespace rigproof;
using Clock = std::chrono::steady_clock;

struct Kind {
  const char* name;
  BoardPictureOptions picture;
  double hidden;  // share of the board
};

std::vector<Kind> kinds() {
  BoardPictureOptions noisy, cluttered;
  noisy.noise_sigma = 2.0;
  cluttered.clutter = true;
  return {{"clean", {}, 0.0}, {"noise 2", noisy, 0.0}, {"clutter", cluttered, 0.0}, {"half hidden", noisy, 0.5}};
}

}  // namespace

int main(int argc, char** argv) {
  const int views = argc > 1 ? std::atoi(argv[1]) : 100;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoi(argv[2]) : 7);
  MarkedViews kind;
  kind.grids = argc > 3 && std::string(argv[3]) == "aprilgrid";
  kind.farthest_m = argc > 4 ? std::atof(argv[4]) : (kind.grids ? 2.0 : 4.0);
  std::printf("%-12s %5s %6s %5s %8s  %7s %8s %7s %10s %6s\n", "picture", "of", "missed", "wrong", "lost", "rms px",
              "whitened", "largest", "pose/bound", "ms");
  for (const auto& [name, picture, hidden] : kinds()) {
    kind.hidden = hidden;
    const auto start = Clock::now();
    const CharucoCounts counts = count_views(views, picture, seed, kind);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    std::printf("%-12s %5d %6d %5d %8d  %7.4f %8.3f %7.3f %10.2f %6.0f", name, counts.views, counts.missed,
                counts.wrong, counts.lost, counts.rms_px(), counts.whitened(), counts.largest, counts.poses_by_bound(),
                1e3 * seconds / views);
    for (const auto& [code, count] : counts.reasons) std::printf(" %s %d", code.c_str(), count);
    std::printf("\n");
    std::fflush(stdout);
  }
  return 0;
}
