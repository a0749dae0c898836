#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "drive_poses.h"
#include "inspect_pictures.h"
#include "inspect_rig.h"
#include "rigproof/core/conventions.h"

namespace rigproof::inspect_detail {
namespace {

using Point = Eigen::Vector3d;

// As in the report.
constexpr Color kBody{195, 202, 210}, kEdge{92, 102, 114}, kTrue{51, 58, 66}, kDark{26, 29, 33}, kLight{250, 250, 250};

Shape line(const Point& from, const Point& to, const Color& color, double thickness) {
  return {{from, to}, {}, 0.0, color, thickness};
}

// No file tells how the robot looks: a box below the cameras with four wheels, forward in its frame.
struct Body {
  double front = 0.3, back = -0.3, half = 0.25;
  double bottom = 0.0, top = 0.0;

  double wheel() const { return 0.3 * top; }
  Point inside(const Point& p) const { return {std::clamp(p.x(), back, front), std::clamp(p.y(), -half, half), top}; }
};

Body body_below(const std::vector<Point>& places) {
  Body body;
  double lowest = 1.0;
  for (const Point& p : places) {
    body.front = std::max(body.front, p.x());
    body.back = std::min(body.back, p.x() - 0.1);
    body.half = std::max(body.half, 0.9 * std::abs(p.y()));
    lowest = std::min(lowest, p.z());
  }
  body.top = std::clamp(0.6 * lowest, 0.15, 0.38);
  body.bottom = 0.2 * body.top;
  return body;
}

void add_box(const Body& body, std::vector<Shape>* shapes) {
  const auto at = [&body](bool front, bool left, bool top) {
    return Point(front ? body.front : body.back, left ? body.half : -body.half, top ? body.top : body.bottom);
  };
  const auto add = [&](std::vector<Point> points, double strength) {
    shapes->push_back({std::move(points), kBody.pale(strength), 0.65, kEdge, 1.0});
  };
  for (const bool top : {false, true})
    add({at(true, true, top), at(true, false, top), at(false, false, top), at(false, true, top)}, 0.7);
  for (const bool front : {false, true})
    add({at(front, true, true), at(front, false, true), at(front, false, false), at(front, true, false)}, 1.0);
  for (const bool left : {false, true})
    add({at(true, left, true), at(false, left, true), at(false, left, false), at(true, left, false)}, 0.85);
}

void add_wheels(const Body& body, std::vector<Shape>* shapes) {
  constexpr int kPoints = 28;
  const double radius = body.wheel();
  for (const double x : {body.back + radius, body.front - radius}) {
    for (const double y : {-body.half - 0.045, body.half + 0.045}) {
      Shape wheel{{}, kEdge, 1.0, kInk, 0.8};
      for (int i = 0; i < kPoints; ++i) {
        const double angle = 2.0 * kPi * i / kPoints;
        wheel.points.emplace_back(x + radius * std::cos(angle), y, radius + radius * std::sin(angle));
      }
      shapes->push_back(std::move(wheel));
    }
  }
}

void add_robot(const Body& body, const std::vector<Point>& places, std::vector<Shape>* shapes) {
  add_box(body, shapes);
  add_wheels(body, shapes);
  for (const Point& p : places)
    if (p.z() > body.top) shapes->push_back(line(body.inside(p), p, kEdge, 1.2));
}

void add_estimated(const Frustum& frustum, const Color& color, std::vector<Shape>* shapes) {
  for (std::size_t i = 0; i < frustum.mouth.size(); ++i)
    shapes->push_back(
        {{frustum.apex, frustum.mouth[i], frustum.mouth[(i + 1) % frustum.mouth.size()]}, color, 0.16, color, 1.6});
  shapes->push_back({frustum.roof, color, 0.9, color, 1.6});
}

void add_true(const Frustum& frustum, std::vector<Shape>* shapes) {
  for (const Point& corner : frustum.mouth) shapes->push_back({{frustum.apex, corner}, {}, 0.0, kTrue, 1.1, true});
  shapes->push_back({frustum.mouth, {}, 0.0, kTrue, 1.1, true});
  shapes->push_back({frustum.roof, kTrue, 0.2, kTrue, 1.1, true});
}

// Its axes, and what the three planes through two of them cut.
void add_ellipsoid(const Point& middle, const Eigen::Matrix3d& covariance, double sigmas, const Color& color,
                   std::vector<Shape>* shapes) {
  constexpr int kPoints = 40;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  const Eigen::Vector3d half = sigmas * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Matrix3d reach = axes.eigenvectors() * half.asDiagonal();
  for (int first = 0; first < 3; ++first) {
    Shape cut{{}, color, 0.22, color, 0.7};
    for (int i = 0; i < kPoints; ++i) {
      const double angle = 2.0 * kPi * i / kPoints;
      cut.points.push_back(middle + std::cos(angle) * reach.col(first) + std::sin(angle) * reach.col((first + 1) % 3));
    }
    shapes->push_back(std::move(cut));
    shapes->push_back(line(middle - reach.col(first), middle + reach.col(first), color, 1.0));
  }
}

void add_camera(const MountedCamera& camera, const Camera& lens, double length_m, double factor,
                std::vector<Shape>* shapes) {
  if (camera.T_true) add_true(frustum_of(lens, *camera.T_true, length_m), shapes);
  if (!camera.T_estimate) return;
  const Color color = camera_color(camera.index);
  const Rigid3 T = exaggerated(camera, factor);
  add_estimated(frustum_of(lens, T, length_m), color, shapes);
  if (camera.covariance)
    add_ellipsoid(T.translation, camera.covariance->topLeftCorner<3, 3>(), 2.0 * factor, color, shapes);
  if (camera.T_true) shapes->push_back(line(camera.T_true->translation, T.translation, kAccent, 1.0));
}

// Square by square, and a short line to where its printed face looks.
void add_board(const Board& board, const Rigid3& T, std::vector<Shape>* shapes) {
  const int columns = board.inner_corners_x() + 1, rows = board.inner_corners_y() + 1;
  for (int iy = 0; iy < rows; ++iy) {
    for (int ix = 0; ix < columns; ++ix) {
      Shape square{{}, board.is_dark(ix, iy) ? kDark : kLight, 1.0, kEdge, 0.4};
      for (const auto& [dx, dy] : {std::pair(-1, -1), std::pair(0, -1), std::pair(0, 0), std::pair(-1, 0)})
        square.points.push_back(T * Point(board.along(ix + dx), board.along(iy + dy), 0.0));
      shapes->push_back(std::move(square));
    }
  }
  const Point middle = T * board.centre();
  shapes->push_back(line(middle, middle - 0.2 * (T.rotation * Point::UnitZ()), kDark, 1.5));
}

// The boards from the stop that has one nearest, as far as they are near there.
void add_boards(const InspectInput& input, RigShapes* shapes) {
  constexpr double kNear_m = 2.0;
  if (input.observations.stops.empty()) return;
  const DrivePoses poses = drive_poses(input);
  const auto board_from = [&](std::size_t stop, std::size_t b) -> std::optional<Rigid3> {
    if (!poses.T_world_board[b]) return std::nullopt;
    return poses.driven[stop].inverse() * *poses.T_world_board[b];
  };
  const auto distance = [&](std::size_t stop, std::size_t b) {
    const std::optional<Rigid3> T = board_from(stop, b);
    return T ? (*T * input.observations.board_at(static_cast<int>(b)).centre()).norm() : kNear_m;
  };
  double nearest = kNear_m;
  for (std::size_t stop = 0; stop < poses.driven.size(); ++stop)
    for (std::size_t b = 0; b < poses.T_world_board.size(); ++b)
      if (distance(stop, b) < nearest) {
        nearest = distance(stop, b);
        shapes->stop = static_cast<int>(stop);
      }
  for (std::size_t b = 0; shapes->stop && b < poses.T_world_board.size(); ++b)
    if (const auto stop = static_cast<std::size_t>(*shapes->stop); distance(stop, b) < kNear_m)
      add_board(input.observations.board_at(static_cast<int>(b)), *board_from(stop, b), &shapes->solid);
}

void add_ground(RigShapes* shapes) {
  Eigen::AlignedBox2d area;
  for (const Shape& shape : shapes->solid)
    for (const Point& p : shape.points) area.extend(Eigen::Vector2d(p.head<2>()));
  const double step = shapes->grid_m = round_step(area.sizes().maxCoeff() / 5.0);
  const Eigen::Vector2d low = step * (area.min() / step).array().floor();
  const Eigen::Vector2d high = step * (area.max() / step).array().ceil();
  const auto add = [&](double x0, double y0, double x1, double y1) {
    shapes->ground.push_back(line({x0, y0, 0.0}, {x1, y1, 0.0}, kRule, 1.0));
  };
  for (double x = low.x(); x < high.x() + 0.5 * step; x += step) add(x, low.y(), x, high.y());
  for (double y = low.y(); y < high.y() + 0.5 * step; y += step) add(low.x(), y, high.x(), y);
}

}  // namespace

Frustum frustum_of(const Camera& camera, const Rigid3& T_robot_camera, double length_m) {
  constexpr double kWidest = 1.6;  // of a fisheye: no longer than this, by its length
  Frustum frustum{T_robot_camera.translation, {}, {}};
  const std::array<Point, 4> rays = image_corner_rays(camera);
  for (const Point& ray : rays)
    frustum.mouth.push_back(T_robot_camera * (length_m * std::min(1.0, kWidest / ray.norm()) * ray));
  const Point& left = frustum.mouth[0];
  const Point& right = frustum.mouth[1];
  const Point up = T_robot_camera.rotation * Point(0.0, -1.0, 0.0);
  frustum.roof = {left, 0.5 * (left + right) + 0.3 * (right - left).norm() * up, right};
  return frustum;
}

std::vector<Eigen::Vector3d> RigShapes::axes() const {
  return {axes_m[0] * Point::UnitX(), axes_m[1] * Point::UnitY(), axes_m[2] * Point::UnitZ()};
}

std::vector<Eigen::Vector3d> RigShapes::seen() const {
  std::vector<Point> points = axes();
  for (const auto* shapes : {&ground, &solid})
    for (const Shape& shape : *shapes) points.insert(points.end(), shape.points.begin(), shape.points.end());
  return points;
}

RigShapes rig_shapes(const InspectInput& input, const MountedRig& rig, double factor) {
  RigShapes shapes;
  const double length_m = frustum_length(rig);
  std::vector<Point> places;
  for (const MountedCamera& camera : rig.cameras)
    if (camera.is_known()) places.push_back(camera.best().translation);
  const Body body = body_below(places);
  shapes.axes_m = {body.front + 0.25, body.half + 0.25, body.top + 0.25};
  add_robot(body, places, &shapes.solid);
  for (const MountedCamera& camera : rig.cameras)
    add_camera(camera, input.observations.cameras[camera.index].camera, length_m, factor, &shapes.solid);
  add_boards(input, &shapes);
  add_ground(&shapes);
  return shapes;
}

}  // namespace rigproof::inspect_detail
