#include "places.h"

#include <algorithm>
#include <cmath>

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

Places::Places(const ViewpointConfig& config, const ViewpointSubject& subject, ViewpointWorld& world)
    : config_(config), subject_(subject), world_(world), area_(world.drivable_area()) {
  const Eigen::Vector3d outward = -(subject.T_scene_board.rotation * Eigen::Vector3d::UnitZ());
  outward_ = outward;
  facing_rad_ = std::atan2(outward.y(), outward.x());
  centre_ = subject.T_scene_board * subject.board.centre();
  for (const Eigen::Vector3d& corner : subject.board.outline()) {
    const Eigen::Vector3d from_centre = corner - subject.board.centre();
    const Eigen::Vector3d border(std::copysign(subject.board_margin_m, from_centre.x()),
                                 std::copysign(subject.board_margin_m, from_centre.y()), 0.0);
    outline_.push_back(subject.T_scene_board * (corner + border));
    // Rays end a little inside of the sheet, where they cannot miss it.
    sight_points_.push_back(subject.T_scene_board * (subject.board.centre() + 0.98 * from_centre));
  }
  sight_points_.push_back(centre_);
}

Viewpoint Places::place(double distance_m, double bearing_rad, double heading_rad) const {
  const double direction = facing_rad_ + bearing_rad;
  return at(centre_.x() + distance_m * std::cos(direction), centre_.y() + distance_m * std::sin(direction),
            direction + kPi + heading_rad);
}

Viewpoint Places::at(double x_m, double y_m, double yaw_rad) const {
  Viewpoint stop;
  stop.x_m = x_m;
  stop.y_m = y_m;
  stop.yaw_rad = wrap_angle(yaw_rad);
  const double dx = x_m - centre_.x(), dy = y_m - centre_.y();
  stop.distance_m = std::hypot(dx, dy);
  stop.bearing_rad = wrap_angle(std::atan2(dy, dx) - facing_rad_);
  return stop;
}

bool Places::inside(const Viewpoint& stop) const {
  return stop.x_m >= area_.x_min && stop.x_m <= area_.x_max && stop.y_m >= area_.y_min && stop.y_m <= area_.y_max;
}

bool Places::faces(std::size_t camera, const Viewpoint& stop) const {
  const WorldCamera& seen_from = subject_.cameras[camera];
  const Rigid3 T_scene_camera = stop.T_scene_robot() * seen_from.T_robot_camera;
  return has_whole_board(seen_from.camera, T_scene_camera) && !is_oblique(T_scene_camera.translation);
}

std::vector<std::size_t> Places::seeing(const Viewpoint& stop) const {
  std::vector<std::size_t> cameras;
  for (std::size_t camera = 0; camera < subject_.cameras.size(); ++camera)
    if (faces(camera, stop) &&
        board_in_sight(stop.T_scene_robot() * subject_.cameras[camera].T_robot_camera.translation))
      cameras.push_back(camera);
  return cameras;
}

std::optional<Rejection> Places::look(int needed, Viewpoint* stop) const {
  const Rigid3 T_scene_robot = stop->T_scene_robot();
  int whole = 0, steep = 0;
  std::vector<Eigen::Vector3d> origins;
  for (const WorldCamera& camera : subject_.cameras) {
    const Rigid3 T_scene_camera = T_scene_robot * camera.T_robot_camera;
    if (!has_whole_board(camera.camera, T_scene_camera)) continue;
    ++whole;
    if (is_oblique(T_scene_camera.translation)) continue;
    ++steep;
    origins.push_back(T_scene_camera.translation);
  }
  if (whole < needed) return kCutOff;
  if (steep < needed) return kOblique;
  stop->cameras_with_board = 0;
  stop->obliquity_rad = 0.0;
  for (const Eigen::Vector3d& origin : origins) {
    if (!board_in_sight(origin)) continue;
    ++stop->cameras_with_board;
    stop->obliquity_rad = std::max(stop->obliquity_rad, obliquity(origin));
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

bool Places::has_whole_board(const Camera& camera, const Rigid3& T_scene_camera) const {
  const Rigid3 T_camera_scene = T_scene_camera.inverse();
  for (const Eigen::Vector3d& corner : outline_) {
    Eigen::Vector2d pixel;
    if (!camera.project(T_camera_scene * corner, &pixel) || !camera.contains(pixel, config_.margin_px)) return false;
  }
  return true;
}

bool Places::is_oblique(const Eigen::Vector3d& origin) const {
  return obliquity(origin) > deg_to_rad(config_.max_obliquity_deg);
}

double Places::obliquity(const Eigen::Vector3d& origin) const {
  return std::acos(std::clamp((origin - centre_).normalized().dot(outward_), -1.0, 1.0));
}

bool Places::board_in_sight(const Eigen::Vector3d& origin) const {
  return std::all_of(sight_points_.begin(), sight_points_.end(),
                     [&](const Eigen::Vector3d& point) { return world_.in_sight(origin, point); });
}

}  // namespace rigproof
