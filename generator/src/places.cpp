#include "places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

constexpr std::array<const char*, kRejections> kRejectionText = {
    "lie outside of the scene's drivable area", "do not have the whole board in enough images",
    "see the board at too flat an angle", "touch something", "have the board hidden behind something"};
constexpr std::array<const char*, kRejections> kRemedy = {
    "change viewpoints.distance_m or bearing_deg, or place the board elsewhere",
    "change viewpoints.distance_m or heading_deg, or lower min_cameras or margin_px",
    "narrow viewpoints.bearing_deg or raise max_obliquity_deg", "change viewpoints.distance_m or bearing_deg",
    "change viewpoints.bearing_deg, or place the board elsewhere"};

}  // namespace

std::string Tally::text() const {
  std::array<std::size_t, kRejections> order{};
  for (std::size_t i = 0; i < kRejections; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [this](std::size_t a, std::size_t b) { return rejected[a] > rejected[b]; });
  std::string text;
  for (const std::size_t i : order) {
    if (rejected[i] == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string((100 * rejected[i] + candidates / 2) / candidates) + " % " +
            kRejectionText[i];
  }
  return text;
}

const char* Tally::remedy() const {
  return kRemedy[static_cast<std::size_t>(std::max_element(rejected.begin(), rejected.end()) - rejected.begin())];
}

Places::Placed::Placed(const ViewedBoard& board)
    : corners(board.board.corner_count()),
      outward(-(board.T_scene_board.rotation * Eigen::Vector3d::UnitZ())),
      centre(board.T_scene_board * board.board.centre()),
      facing_rad(std::atan2(outward.y(), outward.x())) {
  for (const Eigen::Vector3d& corner : board.board.outline()) {
    const Eigen::Vector3d from_centre = corner - board.board.centre();
    const Eigen::Vector3d border(std::copysign(board.board_margin_m, from_centre.x()),
                                 std::copysign(board.board_margin_m, from_centre.y()), 0.0);
    outline.push_back(board.T_scene_board * (corner + border));
    // Rays end a little inside of the sheet, where they cannot miss it.
    sight_points.push_back(board.T_scene_board * (board.board.centre() + 0.98 * from_centre));
  }
  sight_points.push_back(centre);
}

double Places::Placed::obliquity(const Eigen::Vector3d& origin) const {
  return std::acos(std::clamp((origin - centre).normalized().dot(outward), -1.0, 1.0));
}

Places::Places(const ViewpointConfig& config, const ViewpointSubject& subject, ViewpointWorld& world)
    : config_(config), subject_(subject), world_(world), area_(world.drivable_area()) {
  for (std::size_t i = 0; i < subject.boards(); ++i) boards_.emplace_back(subject.board_at(i));
}

Rigid3 Places::board_on_floor() const {
  const Placed& board = boards_.front();
  return planar_pose(board.centre.x(), board.centre.y(), board.facing_rad);
}

Viewpoint Places::place(double distance_m, double bearing_rad, double heading_rad, std::size_t board) const {
  const Eigen::Vector3d& centre = boards_[board].centre;
  const double direction = boards_[board].facing_rad + bearing_rad;
  return at(centre.x() + distance_m * std::cos(direction), centre.y() + distance_m * std::sin(direction),
            direction + kPi + heading_rad);
}

Viewpoint Places::at(double x_m, double y_m, double yaw_rad) const {
  Viewpoint stop;
  stop.x_m = x_m;
  stop.y_m = y_m;
  stop.yaw_rad = wrap_angle(yaw_rad);
  stop.distance_m = std::numeric_limits<double>::infinity();
  for (const Placed& board : boards_) {
    const double dx = x_m - board.centre.x(), dy = y_m - board.centre.y(), distance_m = std::hypot(dx, dy);
    if (distance_m >= stop.distance_m) continue;
    stop.distance_m = distance_m;
    stop.bearing_rad = wrap_angle(std::atan2(dy, dx) - board.facing_rad);
  }
  return stop;
}

bool Places::inside(const Viewpoint& stop) const {
  return stop.x_m >= area_.x_min && stop.x_m <= area_.x_max && stop.y_m >= area_.y_min && stop.y_m <= area_.y_max;
}

std::vector<Sight> Places::sights(const Viewpoint& stop, bool with_what_hides) const {
  std::vector<Sight> sights;
  for (std::size_t c = 0; c < subject_.cameras.size(); ++c) {
    const Rigid3 T_scene_camera = stop.T_scene_robot() * subject_.cameras[c].T_robot_camera;
    const Eigen::Vector3d& origin = T_scene_camera.translation;
    std::optional<std::size_t> largest;
    for (std::size_t b = 0; b < boards_.size(); ++b) {
      if (largest && boards_[b].corners <= boards_[*largest].corners) continue;
      if (!has_whole(boards_[b], subject_.cameras[c].camera, T_scene_camera) || is_oblique(boards_[b], origin))
        continue;
      if (!with_what_hides || in_sight(b, origin)) largest = b;
    }
    if (largest) sights.push_back({c, *largest});
  }
  return sights;
}

std::optional<Rejection> Places::look(int needed, Viewpoint* stop) const {
  const Rigid3 T_scene_robot = stop->T_scene_robot();
  int whole = 0, steep = 0;
  for (const WorldCamera& camera : subject_.cameras) {
    const Rigid3 T_scene_camera = T_scene_robot * camera.T_robot_camera;
    bool any_whole = false, any_steep = false;
    for (const Placed& board : boards_) {
      if (!has_whole(board, camera.camera, T_scene_camera)) continue;
      any_whole = true;
      any_steep = any_steep || !is_oblique(board, T_scene_camera.translation);
    }
    whole += any_whole;
    steep += any_steep;
  }
  if (whole < needed) return kCutOff;
  if (steep < needed) return kOblique;
  stop->cameras_with_board = 0;
  stop->obliquity_rad = 0.0;
  for (const Sight& sight : seeing(*stop)) {
    ++stop->cameras_with_board;
    const Eigen::Vector3d origin = (T_scene_robot * subject_.cameras[sight.camera].T_robot_camera).translation;
    stop->obliquity_rad = std::max(stop->obliquity_rad, boards_[sight.board].obliquity(origin));
  }
  if (stop->cameras_with_board < needed) return kHidden;
  return std::nullopt;
}

std::optional<Rejection> Places::check(int needed, Viewpoint* stop) const {
  if (!inside(*stop)) return kOutside;
  if (const std::optional<Rejection> rejection = look(needed, stop)) return rejection;
  if (!world_.obstacle(stop->T_scene_robot()).empty()) return kCollision;
  return std::nullopt;
}

bool Places::has_whole(const Placed& board, const Camera& camera, const Rigid3& T_scene_camera) const {
  const Rigid3 T_camera_scene = T_scene_camera.inverse();
  return std::all_of(board.outline.begin(), board.outline.end(), [&](const Eigen::Vector3d& corner) {
    Eigen::Vector2d pixel;
    return camera.project(T_camera_scene * corner, &pixel) && camera.contains(pixel, config_.margin_px);
  });
}

bool Places::is_oblique(const Placed& board, const Eigen::Vector3d& origin) const {
  return board.obliquity(origin) > deg_to_rad(config_.max_obliquity_deg);
}

bool Places::in_sight(std::size_t board, const Eigen::Vector3d& origin) const {
  const std::vector<Eigen::Vector3d>& points = boards_[board].sight_points;
  return std::all_of(points.begin(), points.end(),
                     [&](const Eigen::Vector3d& point) { return world_.in_sight(origin, point, board); });
}

}  // namespace rigproof
