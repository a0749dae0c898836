// The board: geometry, corner order and its symmetries.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/conventions.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Where a board stands against the first one of a recording, as somebody measured it.
struct BoardPlace {
  Rigid3 T_first_board;
  /// One sigma of it, along and about each axis. Assumed: a tape measure and an eye, over a metre or two.
  double sigma_m = 0.005;
  double sigma_rad = 0.5 * kPi / 180.0;
};

/// A board of squares_x by squares_y squares. Its corners carry ids in row order: id = iy * inner_corners_x() + ix, at
/// (along(ix), along(iy), 0) in the board frame. The square diagonally outside corner 0 (in the board's -x -y corner)
/// is dark, unless `legacy_pattern` says otherwise.
///
/// An AprilGrid's squares are cells of side square_m with a tag in the middle of each; its corners are those of its
/// tags, two a cell along each axis. With the small dark squares between the tags, as Kalibr prints them, it is a
/// checkerboard of columns and rows that are a gap and a tag wide in turn.
struct Board {
  std::string type = "checkerboard";
  int squares_x = 5;
  int squares_y = 4;
  double square_m = 0.1;
  /// One sigma of the side of the squares; absent: half a percent of it, as printers leave it. 0: exact.
  std::optional<double> square_sigma_m;
  /// One sigma of how far the sheet bows out of its plane, from its middle to its edges along x and along y; absent: as
  /// far as the longer side goes with 0.3 mm over that of an A3 sheet. 0: flat.
  std::optional<double> bow_sigma_m;
  /// One sigma of where each corner lies against all of these, along each axis; absent: 0.05 mm, of print and paper.
  std::optional<double> print_sigma_m;
  /// Of a ChArUco board: its markers' dictionary as OpenCV calls it; empty: the smallest of 5 x 5 bits that has enough.
  std::string dictionary = {};
  /// The side of a ChArUco board's markers or an AprilGrid's tags; absent: three quarters of the square's, or the
  /// square's over 1.3, as Kalibr has gaps of 0.3 tags.
  std::optional<double> marker_m = {};
  /// Of a ChArUco board with an even number of rows: its first square is light, as OpenCV before 4.6 drew it.
  bool legacy_pattern = false;
  /// Of a board beside the first one; absent: it may stand anywhere.
  std::optional<BoardPlace> place = {};

  /// From now on exactly as stated.
  void believe() { square_sigma_m = bow_sigma_m = print_sigma_m = 0.0; }
  /// From now on known as usual.
  void doubt() {
    square_sigma_m.reset();
    bow_sigma_m.reset();
    print_sigma_m.reset();
  }
  double square_sigma_relative() const { return square_sigma_m ? *square_sigma_m / square_m : 0.005; }
  double bow_sigma() const {
    constexpr double kOverA3_m = 0.0003, kA3_m = 0.42;
    return bow_sigma_m.value_or(kOverA3_m / kA3_m * square_m * std::max(squares_x, squares_y));
  }
  double print_sigma() const { return print_sigma_m.value_or(5e-5); }
  bool has_tags() const { return type == "aprilgrid"; }
  double marker_side_m() const { return marker_m.value_or(has_tags() ? square_m / 1.3 : 0.75 * square_m); }
  int inner_corners_x() const { return has_tags() ? 2 * squares_x : squares_x - 1; }
  int inner_corners_y() const { return has_tags() ? 2 * squares_y : squares_y - 1; }
  int corner_count() const { return inner_corners_x() * inner_corners_y(); }
  /// Where the i-th line of corners lies along x or y [board frame, m]; -1 and the number of corners: the outer edges.
  double along(int i) const {
    if (!has_tags()) return square_m * i;
    const int cell = (i + 2) / 2 - 1;  // rounded down
    return square_m * cell + (i - 2 * cell) * marker_side_m();
  }
  Eigen::Vector3d corner(int id) const { return {along(id % inner_corners_x()), along(id / inner_corners_x()), 0.0}; }
  std::vector<Eigen::Vector3d> corners() const;
  /// The four outer corners of the squares, in the order (-,-), (+,-), (+,+), (-,+) [board frame, m].
  std::vector<Eigen::Vector3d> outline() const;
  /// Centre of the squares [board frame, m].
  Eigen::Vector3d centre() const;
  /// True if the area in column ix, row iy between corners (0-based, from the -x -y corner) is dark.
  bool is_dark(int ix, int iy) const { return ((ix + iy) % 2 == 0) != (legacy_pattern && squares_y % 2 == 0); }
  /// True if the board turned by 180 degrees looks the same, so that its first corner cannot be told by colours.
  bool ambiguous_under_half_turn() const { return (squares_x + squares_y) % 2 == 0; }
  bool operator==(const Board& other) const {
    return type == other.type && squares_x == other.squares_x && squares_y == other.squares_y &&
           square_m == other.square_m && dictionary == other.dictionary && marker_m == other.marker_m &&
           legacy_pattern == other.legacy_pattern;
  }
};

}  // namespace rigproof
