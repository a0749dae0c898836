// bench_detection_mrgingham [VIEWS]: our corners and those of mrgingham in the same pictures, against the true ones.
// mrgingham reads N x N grids alone, which look the same after half a turn and are no board of ours; so it is shown a
// board of 12 x 11 squares whose last column is hidden, we the whole one, and the common 10 x 10 corners are compared.
// Needs the program: apt-get install mrgingham.
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>

#include "foreign_picture.h"
#include "rigproof/calib/vision/checkerboard.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"
#include "temp_folder.h"

namespace {

using namespace rigproof;
namespace fs = std::filesystem;
using Eigen::Vector2d;
using Corners = std::map<int, Vector2d>;  // by id

constexpr int kGrid = 10;            // corners along each side
constexpr double kSameCorner = 0.3;  // of the distance to the next true corner
constexpr double kWhite = 215.0;

struct View {
  Camera camera;
  Board board;
  Rigid3 T_camera_board;
  Corners truth;
  double spacing_px = 0.0;
};

View view_of(std::uint64_t seed, const ForeignPicture& kind) {
  RandomStream random(seed, "mrgingham view");
  View view;
  view.camera = foreign_view(seed).camera;
  view.board.squares_x = kGrid + 2;
  view.board.squares_y = kGrid + 1;
  view.board.square_m = 0.04;
  const double width = view.camera.width_px, height = view.camera.height_px;
  const double distance = random.uniform(1.2, 1.8) * view.camera.fx_px / width;
  view.T_camera_board =
      board_in_view(view.camera, view.board, distance, deg_to_rad(random.uniform(0.0, 35.0)), random.uniform(0.0, kPi),
                    deg_to_rad(random.uniform(-20.0, 20.0)), {0.5 * width, 0.5 * height});
  const std::vector<Vector2d> all = true_corners(view.camera, view.board, view.T_camera_board, kind.picture);
  for (std::size_t id = 0; id < all.size(); ++id)
    if (static_cast<int>(id) % view.board.inner_corners_x() < kGrid && view.camera.contains(all[id], 5.0))
      view.truth[static_cast<int>(id)] = all[id];
  view.spacing_px = view.truth.size() > 1 ? (all[1] - all[0]).norm() : 0.0;
  return view;
}

ForeignPicture without_last_column(ForeignPicture kind) {
  kind.picture.hidden_from_x = kGrid + 1;
  kind.picture.hidden_to_x = kGrid + 4;
  kind.picture.background = kWhite;
  return kind;
}

// By image; an image without a board has none.
std::map<std::string, std::vector<Vector2d>> mrgingham_corners(const fs::path& folder) {
  const std::string command = "mrgingham --gridn " + std::to_string(kGrid) + " '" + (folder / "*.png").string() +
                              "' >'" + (folder / "corners.vnl").string() + "'";
  if (std::system("command -v mrgingham >/dev/null") != 0)
    throw std::runtime_error("mrgingham is not installed: apt-get install mrgingham");
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
  std::map<std::string, std::vector<Vector2d>> corners;
  std::ifstream in(folder / "corners.vnl");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string file;
    Vector2d p;
    if (line.rfind('#', 0) != 0 && words >> file >> p.x() >> p.y()) corners[fs::path(file).filename()].push_back(p);
  }
  return corners;
}

Corners by_truth(const std::vector<Vector2d>& pixels, const View& view) {
  Corners corners;
  for (const Vector2d& p : pixels)
    for (const auto& [id, truth] : view.truth)
      if ((p - truth).norm() < kSameCorner * view.spacing_px) corners[id] = p;
  return corners;
}

Corners our_corners(const Image8& image, const View& view) {
  Corners corners;
  const BoardDetection detection = detect_checkerboard(image, view.board);
  if (const auto* seen = std::get_if<std::vector<CornerObservation>>(&detection))
    for (const CornerObservation& corner : *seen)
      if (view.truth.count(corner.id) > 0) corners[corner.id] = corner.pixel;
  return corners;
}

struct Errors {
  double squares = 0.0, largest = 0.0;
  int corners = 0, boards = 0;

  void add(const Corners& seen, const Corners& others) {
    boards += !seen.empty();
    for (const auto& [id, pixel] : seen) {
      const auto other = others.find(id);
      if (other == others.end()) continue;
      const Vector2d error = pixel - other->second;
      squares += 0.5 * error.squaredNorm();
      largest = std::max(largest, error.norm());
      ++corners;
    }
  }
  double rms() const { return corners > 0 ? std::sqrt(squares / corners) : NAN; }
};

void judge(const ForeignPicture& kind, int views) {
  const TempFolder folder;
  std::vector<View> seen;
  std::vector<Corners> ours;
  for (int i = 0; i < views; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    seen.push_back(view_of(seed, kind));
    const View& view = seen.back();
    ours.push_back(our_corners(draw_foreign(view.camera, view.board, view.T_camera_board, kind, seed), view));
    Image8 image = draw_foreign(view.camera, view.board, view.T_camera_board, without_last_column(kind), seed);
    cv::imwrite((folder / (std::to_string(i) + ".png")).string(),
                cv::Mat(image.height, image.width, CV_8UC1, image.pixels.data()));
  }
  const auto found = mrgingham_corners(folder.path());
  Errors we, they, between;
  for (int i = 0; i < views; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto list = found.find(std::to_string(i) + ".png");
    const Corners theirs = list == found.end() ? Corners() : by_truth(list->second, seen[k]);
    we.add(ours[k], seen[k].truth);
    they.add(theirs, seen[k].truth);
    between.add(ours[k], theirs);
  }
  std::printf("%-20s %3d  %4d %7.4f %7.3f  %4d %7.4f %7.3f  %7.4f\n", kind.name.c_str(), views, we.boards, we.rms(),
              we.largest, they.boards, they.rms(), they.largest, between.rms());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int views = argc > 1 ? std::atoi(argv[1]) : 20;
    std::printf("%-20s %3s  %4s %7s %7s  %4s %7s %7s  %7s\n", "picture", "of", "ours", "rms px", "largest", "mrg.",
                "rms px", "largest", "between");
    for (const ForeignPicture& kind : foreign_pictures()) judge(kind, views);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
