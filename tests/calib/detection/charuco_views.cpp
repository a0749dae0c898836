#include "charuco_views.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>

#include "rigproof/calib/geometry/pnp.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

using Eigen::Vector2d;

Board random_board(RandomStream& random) {
  struct Kind {
    int x, y;
    const char* dictionary;
    double share;
    bool legacy;
  };
  static constexpr std::array<Kind, 5> kKinds = {{{7, 5, "", 0.75, false},
                                                  {5, 7, "DICT_6X6_250", 0.5, false},
                                                  {6, 4, "DICT_4X4_50", 0.75, true},
                                                  {8, 6, "DICT_5X5_100", 0.8, false},
                                                  {5, 4, "DICT_7X7_100", 0.7, false}}};
  const Kind& kind = kKinds[random.below(kKinds.size())];
  Board board{"charuco", kind.x, kind.y, 0.1, {}, {}, {}};
  board.dictionary = kind.dictionary;
  board.marker_m = kind.share * board.square_m;
  board.legacy_pattern = kind.legacy;
  return board;
}

bool whole_in_view(const CharucoView& view) {
  for (const Eigen::Vector3d& p : view.board.outline()) {
    Vector2d pixel;
    if (!view.camera.project(view.T_camera_board * p, &pixel) || !view.camera.contains(pixel, 3.0)) return false;
  }
  return true;
}

// Tags of the shipped grid's size.
Board random_grid(RandomStream& random) {
  struct Kind {
    int x, y;
    double gap;
  };
  static constexpr std::array<Kind, 4> kKinds = {{{6, 4, 0.3}, {6, 6, 0.3}, {5, 3, 0.25}, {4, 3, 0.4}}};
  const Kind& kind = kKinds[random.below(kKinds.size())];
  Board board{"aprilgrid", kind.x, kind.y, 0.1 * (1.0 + kind.gap), {}, {}, {}};
  board.marker_m = 0.1;
  return board;
}

// Where a share of the board's columns ends, in squares of the picture: an AprilGrid's begin one before its tags.
double end_of_share(double share, const Board& board) {
  return (board.has_tags() ? 1.0 : 0.0) + share * board.squares_x;
}

}  // namespace

CharucoView random_view(const MarkedViews& views, RandomStream& random) {
  for (;;) {
    CharucoView view{views.grids ? random_grid(random) : random_board(random), Camera::symmetric(1280, 720, 640.0), {}};
    const double distance = random.uniform(0.8, views.farthest_m), obliquity = deg_to_rad(random.uniform(0.0, 60.0));
    const double axis = random.uniform(0.0, 2.0 * kPi), roll = random.uniform(0.0, 2.0 * kPi);
    const Vector2d pixel(random.uniform(0.05, 0.95) * view.camera.width_px,
                         random.uniform(0.05, 0.95) * view.camera.height_px);
    view.T_camera_board = board_in_view(view.camera, view.board, distance, obliquity, axis, roll, pixel);
    if (whole_in_view(view)) return view;
  }
}

void CharucoCounts::add(const CharucoView& view, const BoardPictureOptions& picture) {
  ++views;
  const Image8 image = draw_board(view.camera, view.board, view.T_camera_board, picture);
  const BoardDetection detection = detect_by_markers(image, view.board);
  if (const auto* none = std::get_if<BoardNotFound>(&detection)) {
    ++missed;
    ++reasons[none->why.code];
    return;
  }
  const auto& seen = std::get<std::vector<CornerObservation>>(detection);
  const std::vector<Vector2d> truth = true_corners(view.camera, view.board, view.T_camera_board, picture);
  bool right = true;
  for (const CornerObservation& corner : seen) {
    const Vector2d error = corner.pixel - truth[static_cast<std::size_t>(corner.id)];
    right = right && error.norm() < 1.0;
    largest = std::max(largest, error.norm());
    squares += error.squaredNorm();
    nees += error.dot(corner.covariance_px2.inverse() * error);
    ++corners;
  }
  if (const auto pose = estimate_board_pose(seen, view.board, view.camera); right && pose) {
    const Vector6d error = transform_error(pose->T_camera_board, view.T_camera_board);
    pose_nees += error.dot(pose->covariance.inverse() * error);
    ++poses;
  }
  wrong += !right;
  lost += static_cast<int>(truth.size() - seen.size());
}

CharucoCounts count_views(int views, const BoardPictureOptions& picture, std::uint64_t seed, const MarkedViews& kind) {
  RandomStream random(seed, "ChArUco views");
  CharucoCounts counts;
  for (int i = 0; i < views; ++i) {
    BoardPictureOptions own = picture;
    own.seed = seed * 1000 + static_cast<std::uint64_t>(i);
    const CharucoView view = random_view(kind, random);
    if (kind.hidden > 0.0) own.hidden_to_x = end_of_share(kind.hidden, view.board);
    counts.add(view, own);
  }
  return counts;
}

}  // namespace rigproof
