// Where to turn for cameras that have not seen the board.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "outlook.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/random.h"

namespace rigproof::suggest {
namespace {

constexpr int kDegrees = 360;
// How likely it is that a camera looks into each direction about the robot, in whole degrees to the left of ahead; in
// proportion.
using Directions = std::array<double, kDegrees>;

int degree(double angle_rad) {
  const int deg = static_cast<int>(std::lround(rad_to_deg(angle_rad))) % kDegrees;
  return deg < 0 ? deg + kDegrees : deg;
}

template <typename Change>
void for_directions(double middle_rad, double half_rad, const Change& change) {
  const int half_deg = static_cast<int>(rad_to_deg(half_rad)), middle_deg = degree(middle_rad);
  for (int off = -half_deg; off <= half_deg && off < kDegrees - half_deg; ++off)
    change(static_cast<std::size_t>((middle_deg + off + kDegrees) % kDegrees));
}

struct Sight {
  int camera = 0;
  double half_whole_rad = 0.0;  // to either side of where it looks the whole board is in its image
  double half_part_rad = 0.0;   // some of it is
  Directions looks{};

  double hope(int board_deg) const {
    double sum = 0.0;
    for_directions(deg_to_rad(board_deg), half_whole_rad, [&](std::size_t d) { sum += looks[d]; });
    return sum;
  }
};

double bearing_of_board(const Outlook& outlook, int which, const Place& place) {
  const Eigen::Vector3d board = outlook.board_centre(which);
  return wrap_angle(std::atan2(board.y() - place.y_m, board.x() - place.x_m) - place.yaw_rad);
}

Sight sight_of(const Outlook& outlook, int camera, int which, const Place& place) {
  constexpr double kLeast_rad = 0.09;
  const Camera& lens = outlook.used().cameras[static_cast<std::size_t>(camera)].camera;
  const Eigen::Vector3d centre = outlook.board_centre(which);
  const Board& board = outlook.used().board_at(which);
  const double away = std::hypot(centre.x() - place.x_m, centre.y() - place.y_m);
  const double half_view = std::atan(0.5 * lens.width_px / lens.fx_px);
  const double half_board = std::atan(0.5 * board.squares_x * board.square_m / away);
  Sight sight;
  sight.camera = camera;
  sight.half_whole_rad = std::max(kLeast_rad, half_view - half_board);
  sight.half_part_rad = half_view + half_board;
  return sight;
}

bool is_partly_seen(const Exclusion& exclusion) {
  return exclusion.why.is("board.cut_off") || exclusion.why.is("board.partly_hidden");
}

bool is_oblique(const Outlook& outlook, int board, const Place& place) {
  const Eigen::Vector3d centre = outlook.board_centre(board);
  const Eigen::Vector3d sight = centre - Eigen::Vector3d(place.x_m, place.y_m, centre.z());
  const Eigen::Vector3d normal = pose_of_board(outlook.state(), board).rotation * Eigen::Vector3d::UnitZ();
  return normal.dot(sight.normalized()) < std::cos(outlook.options.max_obliquity_rad);
}

// In which directions a camera may look: from a stop at which it found no board, it does not look to where a board
// stands. False if none of its images was searched.
bool learn_from_images(const Outlook& outlook, Sight* sight) {
  bool searched = false;
  sight->looks.fill(1.0);
  for (const Exclusion& exclusion : outlook.used().exclusions) {
    if (exclusion.camera != sight->camera || exclusion.stop < 0 || exclusion.depth) continue;
    const bool partly = is_partly_seen(exclusion);
    if (!partly && !exclusion.why.is("board.not_found")) continue;
    searched = true;
    const Place place = Place::of(outlook.state().T_world_robot[static_cast<std::size_t>(exclusion.stop)]);
    const std::vector<int>& boards = outlook.foresight.boards();
    if (partly && boards.size() > 1) continue;  // of which one is not known
    for (const int board : boards) {
      if (boards.size() > 1 && is_oblique(outlook, board, place))
        continue;  // seen from behind, it is looked for in vain
      const Sight there = sight_of(outlook, sight->camera, board, place);
      for_directions(bearing_of_board(outlook, board, place), partly ? there.half_part_rad : there.half_whole_rad,
                     [&](std::size_t d) { sight->looks[d] = partly ? 2.0 * sight->looks[d] : 0.0; });
    }
  }
  return searched;
}

void look_as_mounted(const Rigid3& T_robot_camera, Sight* sight) {
  constexpr double kMounted_rad = 0.17;  // drawings and robots differ
  const Eigen::Vector3d axis = T_robot_camera.rotation * Eigen::Vector3d::UnitZ();
  sight->looks.fill(0.0);
  for_directions(std::atan2(axis.y(), axis.x()), kMounted_rad, [&](std::size_t d) { sight->looks[d] = 1.0; });
}

std::vector<Sight> unseeing_cameras(const Outlook& outlook, int board, const Place& place) {
  const auto& mounts = outlook.options.T_robot_camera_as_mounted;
  std::vector<Sight> sights;
  for (std::size_t c = 0; c < outlook.knowledge.has_pose.size(); ++c) {
    if (outlook.knowledge.has_pose[c]) continue;
    Sight sight = sight_of(outlook, static_cast<int>(c), board, place);
    if (!learn_from_images(outlook, &sight)) continue;
    if (c < mounts.size() && mounts[c]) look_as_mounted(*mounts[c], &sight);
    sights.push_back(sight);
  }
  return sights;
}

double apart(const Place& a, const Place& b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

// The nearest one whose front is towards the robot; else the nearest one.
int board_to_look_at(const Outlook& outlook) {
  const Place here = outlook.last_place();
  const auto rank = [&](int board) {
    const Eigen::Vector3d centre = outlook.board_centre(board);
    return std::pair(is_oblique(outlook, board, here), std::hypot(centre.x() - here.x_m, centre.y() - here.y_m));
  };
  const std::vector<int>& boards = outlook.foresight.boards();
  return *std::min_element(boards.begin(), boards.end(), [&](int a, int b) { return rank(a) < rank(b); });
}

// A camera without a pose had a part of the board in its image from about there: turned again it would do no better.
bool was_cut_off_from(const Outlook& outlook, const Place& place) {
  constexpr double kAbout_m = 0.3;
  if (outlook.foresight.boards().size() > 1) return false;  // of which one is not known
  const std::vector<Exclusion>& all = outlook.used().exclusions;
  return std::any_of(all.begin(), all.end(), [&](const Exclusion& exclusion) {
    if (exclusion.stop < 0 || !is_partly_seen(exclusion)) return false;
    if (outlook.knowledge.has_pose[static_cast<std::size_t>(exclusion.camera)]) return false;
    const Rigid3& T = outlook.state().T_world_robot[static_cast<std::size_t>(exclusion.stop)];
    return apart(Place::of(T), place) < kAbout_m;
  });
}

// Where the robot stands; the nearest place in front of the board, where that is not; some steps farther away, where
// the board was cut off.
Place place_to_look_from(const Outlook& outlook, int which) {
  constexpr double kStep_m = 0.5;
  const Place here = outlook.last_place();
  const double farther_m = was_cut_off_from(outlook, here) ? kStep_m : 0.0;
  if (!is_oblique(outlook, which, here) && farther_m == 0.0) return here;
  const Eigen::Vector3d board = outlook.board_centre(which);
  const auto from_board = [&board](const Place& place) {
    return std::hypot(place.x_m - board.x(), place.y_m - board.y());
  };
  Place nearest = here;
  double least = std::numeric_limits<double>::infinity();
  for (const Place& place : candidates_of(outlook)) {
    if (is_oblique(outlook, which, place) || apart(place, here) >= least) continue;
    if (farther_m > 0.0 && from_board(place) < from_board(here) + farther_m) continue;
    least = apart(place, here);
    nearest = place;
  }
  return nearest;
}

// Where the board should be about the robot: where most hope lies, and of many such the middle of all hope.
int best_bearing_deg(const std::vector<Sight>& sights) {
  constexpr double kMiddle = 1e-3;
  int best = 0;
  double most = -1.0;
  for (int board_deg = 0; board_deg < kDegrees; ++board_deg) {
    double hope = 0.0;
    for (const Sight& sight : sights) {
      hope += sight.hope(board_deg);
      for (int d = 0; d < kDegrees; ++d)
        hope += kMiddle * sight.looks[static_cast<std::size_t>(d)] * (1.0 + std::cos(deg_to_rad(board_deg - d)));
    }
    if (hope <= most + 1e-9) continue;
    most = hope;
    best = board_deg;
  }
  return best;
}

// Turned on the spot until the board bears so from the robot: its origin swings about the point that it turns about.
Place turned_from_board(const Outlook& outlook, int board, const Place& here, double bearing_rad) {
  constexpr int kRounds = 4;
  Place place = here;
  for (int round = 0; round < kRounds; ++round)
    place =
        here.turned_to(place.yaw_rad + bearing_of_board(outlook, board, place) - bearing_rad, outlook.turns_about_m());
  return place;
}

}  // namespace

std::vector<Look> looks_for_board(const Outlook& outlook) {
  constexpr double kWorthATurn = 0.1;  // of a camera's hope
  const int board = board_to_look_at(outlook);
  const Place here = place_to_look_from(outlook, board);
  std::vector<Sight> sights = unseeing_cameras(outlook, board, here);
  std::vector<double> all;
  for (const Sight& sight : sights) all.push_back(std::accumulate(sight.looks.begin(), sight.looks.end(), 0.0));
  std::vector<Look> looks;
  while (static_cast<int>(looks.size()) < outlook.options.stops) {
    const int board_deg = best_bearing_deg(sights);
    Look look{turned_from_board(outlook, board, here, deg_to_rad(board_deg)), {}};
    for (std::size_t i = 0; i < sights.size(); ++i) {
      Sight& sight = sights[i];
      if (all[i] > 0.0 && sight.hope(board_deg) >= kWorthATurn * all[i]) look.hoped.push_back(sight.camera);
      for_directions(deg_to_rad(board_deg), sight.half_whole_rad, [&](std::size_t d) { sight.looks[d] = 0.0; });
    }
    if (look.hoped.empty()) break;
    looks.push_back(std::move(look));
  }
  return looks;
}

}  // namespace rigproof::suggest
