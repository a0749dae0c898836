#include "faults.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rigproof/core/conventions.h"
#include "rigproof/core/median.h"
#include "rigproof/core/rigid3.h"
#include "stop_edits.h"

namespace rigproof::ml {
namespace {

using Change = std::function<void(Stop*)>;

std::function<void(Observations*)> for_each_stop(const Change& change) {
  return [change](Observations* observations) {
    for (Stop& stop : observations->stops) {
      for (Eigen::Vector3d& pose : stop.way) {
        Stop passed;
        passed.x_m = pose.x();
        passed.y_m = pose.y();
        passed.yaw_rad = pose.z();
        change(&passed);
        pose = {passed.x_m, passed.y_m, passed.yaw_rad};
      }
      change(&stop);
    }
  };
}

Change scale_positions(double factor) {
  return [factor](Stop* stop) {
    stop->x_m *= factor;
    stop->y_m *= factor;
  };
}

void yaw_from_degrees(Stop* stop) { stop->yaw_rad = deg_to_rad(stop->yaw_rad); }

Fault in_unit(const char* unit, double metres) {
  return {FaultKind::kUnit, Finding("odometry.unit", {{"unit", unit}}), false, for_each_stop(scale_positions(metres))};
}

Fault in_unit_and_degrees(const char* unit, double metres) {
  Fault fault = in_unit(unit, metres);
  fault.further = {Finding("odometry.yaw_in_degrees")};
  fault.undo = for_each_stop([scale = scale_positions(metres)](Stop* stop) {
    scale(stop);
    yaw_from_degrees(stop);
  });
  return fault;
}

// Columns x, y and yaw that hold `columns`.
Fault other_columns(const char* columns, const std::function<Eigen::Vector3d(const Stop&)>& x_y_yaw) {
  return {FaultKind::kUnit, Finding("odometry.columns", {{"columns", columns}}), false,
          for_each_stop([x_y_yaw](Stop* stop) {
            const Eigen::Vector3d pose = x_y_yaw(*stop);
            stop->x_m = pose.x();
            stop->y_m = pose.y();
            stop->yaw_rad = pose.z();
          })};
}

// x and y swapped is odometry.axes_swapped.
void add_other_columns(std::vector<Fault>* faults) {
  using Pose = Eigen::Vector3d;
  faults->push_back(
      other_columns("yaw, x, y", [](const Stop& stop) { return Pose(stop.y_m, stop.yaw_rad, stop.x_m); }));
  faults->push_back(
      other_columns("y, yaw, x", [](const Stop& stop) { return Pose(stop.yaw_rad, stop.x_m, stop.y_m); }));
  faults->push_back(
      other_columns("x, yaw, y", [](const Stop& stop) { return Pose(stop.x_m, stop.yaw_rad, stop.y_m); }));
  faults->push_back(
      other_columns("yaw, y, x", [](const Stop& stop) { return Pose(stop.yaw_rad, stop.y_m, stop.x_m); }));
}

Fault yaw_of_quaternion() {
  return {FaultKind::kUnit, Finding("odometry.yaw_of_quaternion"), false,
          for_each_stop([](Stop* stop) { stop->yaw_rad = 2.0 * std::asin(std::clamp(stop->yaw_rad, -1.0, 1.0)); })};
}

bool may_be_of_quaternion(const std::vector<Stop>& stops) {
  return std::all_of(stops.begin(), stops.end(), [](const Stop& stop) { return std::abs(stop.yaw_rad) <= 1.0; });
}

Rigid3 pose_of(const Stop& stop) { return planar_pose(stop.x_m, stop.y_m, stop.yaw_rad); }

void set_pose(const Rigid3& T, Stop* stop) {
  stop->x_m = T.translation.x();
  stop->y_m = T.translation.y();
  stop->yaw_rad = yaw_of(T);
}

Rigid3 between(const Rigid3& from, const Rigid3& to, double share) {
  return from * se3_exp(share * se3_log(from.inverse() * to));
}

// Odometry o'_i = o_(i + stops), with a whole number of stops. Rows that nothing is known about stay as they are: one
// or two wrong rows are outliers.
void shift_rows(int stops, std::vector<Stop>* rows) {
  const std::vector<Stop> shifted = *rows;
  for (int i = 0; i < static_cast<int>(rows->size()); ++i) {
    const int from = i - stops;
    if (from < 0 || from >= static_cast<int>(rows->size())) continue;
    const Stop& source = shifted[static_cast<std::size_t>(from)];
    Stop& row = (*rows)[static_cast<std::size_t>(i)];
    set_pose(pose_of(source), &row);
    row.way = source.way;
  }
}

// o'_i = between(o_i, o_(i+1), share), solved from the end at which the recursion forgets its start.
void undo_interpolation(double share, std::vector<Stop>* rows) {
  const std::size_t n = rows->size();
  if (n < 2) return;
  std::vector<Rigid3> poses;
  for (const Stop& stop : *rows) poses.push_back(pose_of(stop));
  std::vector<Rigid3> original = poses;
  if (share <= 0.5) {
    for (std::size_t i = n - 1; i-- > 0;) original[i] = between(original[i + 1], poses[i], 1.0 / (1.0 - share));
  } else {
    for (std::size_t i = 0; i + 1 < n; ++i) original[i + 1] = between(original[i], poses[i], 1.0 / share);
  }
  for (std::size_t i = 0; i < n; ++i) {
    set_pose(original[i], &(*rows)[i]);
    (*rows)[i].way.clear();  // of rows between stops nothing is known
  }
}

double median_interval_s(const Observations& observations) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < observations.stops.size(); ++i)
    intervals.push_back(observations.stops[i].stamp_s - observations.stops[i - 1].stamp_s);
  return median(std::move(intervals));
}

// Drives the same increments anew, each with the turn that `turn_of` makes of its own. Rows between two stops come at
// even times.
void drive_anew(const std::function<double(double turn_rad, double lasts_s)>& turn_of, std::vector<Stop>* rows) {
  if (rows->empty()) return;
  Rigid3 before = pose_of(rows->front()), after = before;
  for (std::size_t i = 1; i < rows->size(); ++i) {
    Stop& stop = (*rows)[i];
    const double step_s = (stop.stamp_s - (*rows)[i - 1].stamp_s) / static_cast<double>(stop.way.size() + 1);
    const auto drive_to = [&](const Rigid3& pose) {
      const Rigid3 step = before.inverse() * pose;
      before = pose;
      after = after * planar_pose(step.translation.x(), step.translation.y(), turn_of(yaw_of(step), step_s));
    };
    for (Eigen::Vector3d& pose : stop.way) {
      drive_to(planar_pose(pose.x(), pose.y(), pose.z()));
      pose = {after.translation.x(), after.translation.y(), yaw_of(after)};
    }
    drive_to(pose_of(stop));
    set_pose(after, &stop);
  }
}

Finding shifted_stamps(const Observations& observations, double stops) {
  const double size = std::abs(stops);
  return Finding("odometry.stamps", {{"side", stops > 0.0 ? "ahead of" : "behind"},
                                     {"shift_stops", size},
                                     {"shift_s", size * median_interval_s(observations)}});
}

bool looks_alike_mirrored(const Board& board) { return board.squares_x % 2 == 1 || board.squares_y % 2 == 1; }

// Left for right, or upside down.
enum class Mirror { kAlongX, kAlongY };

// A mirrored board looks like one, numbered the other way along a side with an odd number of squares.
void unmirror(const Board& board, const Camera& camera, Mirror mirror, BoardView* view) {
  const int columns = board.inner_corners_x(), rows = board.inner_corners_y();
  for (CornerObservation& corner : view->corners) {
    int x = corner.id % columns, y = corner.id / columns;
    if (board.squares_x % 2 == 1)
      x = columns - 1 - x;
    else
      y = rows - 1 - y;
    corner.id = y * columns + x;
    if (mirror == Mirror::kAlongX)
      corner.pixel.x() = camera.width_px - 1 - corner.pixel.x();
    else
      corner.pixel.y() = camera.height_px - 1 - corner.pixel.y();
    corner.covariance_px2(0, 1) *= -1.0;
    corner.covariance_px2(1, 0) *= -1.0;
  }
  std::sort(view->corners.begin(), view->corners.end(),
            [](const CornerObservation& a, const CornerObservation& b) { return a.id < b.id; });
}

// Rays turn about the middle of the image, not about the principal point.
void unmirror(const Camera& camera, Mirror mirror, PlaneObservation* plane) {
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  if (mirror == Mirror::kAlongX) {
    T(0, 0) = -1.0;
    T(2, 0) = (camera.width_px - 1 - 2.0 * camera.cx_px) / camera.fx_px;
  } else {
    T(1, 1) = -1.0;
    T(2, 1) = (camera.height_px - 1 - 2.0 * camera.cy_px) / camera.fy_px;
  }
  plane->inverse_depth_plane = T * plane->inverse_depth_plane;
  plane->covariance_per_m2 = T * plane->covariance_per_m2 * T.transpose();
}

void unmirror(int camera, Mirror mirror, Observations* observations) {
  const Camera& optics = observations->cameras[static_cast<std::size_t>(camera)].camera;
  for (BoardView& view : observations->board_views)
    if (view.camera == camera) unmirror(observations->board_of(view), optics, mirror, &view);
  for (auto* planes : {&observations->ground_planes, &observations->board_planes})
    for (PlaneObservation& plane : *planes)
      if (plane.camera == camera) unmirror(optics, mirror, &plane);
}

Fault mirrored_images(const Observations& observations, const std::vector<int>& cameras, Mirror mirror) {
  Finding cause("images.mirrored");
  for (const int camera : cameras) cause.cameras.push_back(observations.cameras[static_cast<std::size_t>(camera)].name);
  return {FaultKind::kImages, cause, true, [cameras, mirror](Observations* repaired) {
            for (const int camera : cameras) unmirror(camera, mirror, repaired);
          }};
}

// Beyond what lenses of one make differ by.
bool other_intrinsics(const Camera& a, const Camera& b) {
  constexpr double kFocal = 0.02, kCentre_px = 10.0;
  return a.width_px == b.width_px && a.height_px == b.height_px &&
         (std::abs(std::log(a.fx_px / b.fx_px)) > kFocal || std::abs(a.cx_px - b.cx_px) > kCentre_px ||
          std::abs(a.cy_px - b.cy_px) > kCentre_px);
}

void move_odometry(const Eigen::Vector2d& offset_m, Observations* observations) {
  if (offset_m.isZero(0.0)) return;
  for_each_stop([&offset_m](Stop* stop) {
    const Eigen::Vector3d pose = odometry_of_point({stop->x_m, stop->y_m, stop->yaw_rad}, offset_m);
    stop->x_m = pose.x();
    stop->y_m = pose.y();
  })(observations);
}

}  // namespace

Observations undone(const Fault& fault, Observations observations) {
  const Eigen::Vector2d rotation_centre_m = observations.odometry_noise.rotation_centre_m;
  move_odometry(rotation_centre_m, &observations);
  fault.undo(&observations);
  move_odometry(-rotation_centre_m, &observations);
  return observations;
}

Fault exchanged_folders(const Observations& observations, int first, int second) {
  const auto& cameras = observations.cameras;
  return {FaultKind::kImages,
          Finding("frames.exchanged")
              .of({cameras[static_cast<std::size_t>(first)].name, cameras[static_cast<std::size_t>(second)].name}),
          true, [first, second](Observations* repaired) {
            for (int stop = 0; stop < static_cast<int>(repaired->stops.size()); ++stop)
              swap_frames(stop, first, second, repaired);
          }};
}

std::vector<Fault> image_faults(const Observations& observations) {
  std::vector<Fault> faults;
  std::vector<int> all;
  const int cameras = static_cast<int>(observations.cameras.size());
  for (int c = 0; c < cameras; ++c) all.push_back(c);
  const auto may_be_mirrored = [&observations](int camera) {
    return std::all_of(observations.board_views.begin(), observations.board_views.end(), [&](const BoardView& view) {
      return view.camera != camera || looks_alike_mirrored(observations.board_of(view));
    });
  };
  for (const Mirror mirror :
       {Mirror::kAlongX, Mirror::kAlongY}) {  // they differ by where in the image the lens's axis is
    if (std::all_of(all.begin(), all.end(), may_be_mirrored))
      faults.push_back(mirrored_images(observations, all, mirror));
    for (int c = 0; c < cameras && cameras > 1; ++c)
      if (may_be_mirrored(c)) faults.push_back(mirrored_images(observations, {c}, mirror));
  }
  for (int a = 0; a < cameras; ++a)
    for (int b = a + 1; b < cameras; ++b)
      if (other_intrinsics(observations.cameras[static_cast<std::size_t>(a)].camera,
                           observations.cameras[static_cast<std::size_t>(b)].camera))
        faults.push_back(exchanged_folders(observations, a, b));
  return faults;
}

Fault odometry_scaled(double factor) {
  return {FaultKind::kScale, Finding("odometry.scale", {{"factor", factor}}), false,
          for_each_stop(scale_positions(1.0 / factor))};
}

Fault odometry_drifting(const Observations& observations, double rad_s) {
  const double lasts_s =
      observations.stops.empty() ? 0.0 : observations.stops.back().stamp_s - observations.stops.front().stamp_s;
  const Finding cause("odometry.yaw_drifts",
                      {{"drift_deg_s", rad_to_deg(rad_s)}, {"drift_deg", rad_to_deg(rad_s * lasts_s)}});
  return {FaultKind::kDrift, cause, false, [rad_s](Observations* repaired) {
            drive_anew([rad_s](double turn, double step_s) { return turn - rad_s * step_s; }, &repaired->stops);
          }};
}

Fault turns_scaled(double factor) {
  return {FaultKind::kScale, Finding("odometry.turns_scale", {{"factor", factor}}), false,
          [factor](Observations* repaired) {
            drive_anew([factor](double turn, double) { return turn / factor; }, &repaired->stops);
          }};
}

Fault far_ahead(const Observations& observations, int stops) {
  return {FaultKind::kStamps, shifted_stamps(observations, stops), false, [stops](Observations* repaired) {
            shift_rows(stops, &repaired->stops);
            const int count = static_cast<int>(repaired->stops.size());
            *repaired = stops_between(*repaired, std::max(0, stops), count + std::min(0, stops));
          }};
}

Fault odometry_ahead(const Observations& observations, double stops) {
  const int whole = static_cast<int>(std::floor(stops));
  const double share = stops - whole;
  return {FaultKind::kStamps, shifted_stamps(observations, stops), false, [whole, share](Observations* repaired) {
            if (share > 1e-9) undo_interpolation(share, &repaired->stops);
            shift_rows(whole, &repaired->stops);
          }};
}

std::vector<Fault> odometry_faults(const Observations& observations) {
  std::vector<Fault> faults = {
      {FaultKind::kUnit, Finding("odometry.yaw_in_degrees"), false, for_each_stop(yaw_from_degrees)},
      {FaultKind::kSign, Finding("odometry.yaw_sign"), false,
       for_each_stop([](Stop* stop) { stop->yaw_rad = -stop->yaw_rad; })},
      {FaultKind::kSign, Finding("odometry.axes_swapped"), false,
       for_each_stop([](Stop* stop) { stop->y_m = -stop->y_m; })},
      {FaultKind::kSign, Finding("odometry.mirrored"), false, for_each_stop([](Stop* stop) {
         stop->y_m = -stop->y_m;
         stop->yaw_rad = -stop->yaw_rad;
       })},
      {FaultKind::kSign, Finding("odometry.inverted"), false,
       for_each_stop([](Stop* stop) { set_pose(pose_of(*stop).inverse(), stop); })},
  };
  for (const auto& [unit, metres] :
       {std::pair("millimetres", 1e-3), {"centimetres", 1e-2}, {"inches", 0.0254}, {"feet", 0.3048}}) {
    faults.push_back(in_unit(unit, metres));
    faults.push_back(in_unit_and_degrees(unit, metres));
  }
  add_other_columns(&faults);
  if (may_be_of_quaternion(observations.stops)) faults.push_back(yaw_of_quaternion());
  for (const int stops : {1, -1, 2, -2, 3, -3}) faults.push_back(odometry_ahead(observations, stops));
  return faults;
}

Fault shifted_frames(const Observations& observations, const std::vector<int>& cameras, int by, int from) {
  Finding cause("frames.shifted", {{"to", by > 0 ? "next" : "previous"}});
  if (from > 0) {
    const double stamp_s = observations.stops[static_cast<std::size_t>(from)].stamp_s;
    cause = cause.with({{"from", from}, {"from_s", stamp_s}});
  }
  for (const int c : cameras) cause.cameras.push_back(observations.cameras[static_cast<std::size_t>(c)].name);
  const bool all = cameras.size() == observations.cameras.size();
  return {FaultKind::kFrames, cause, !all,
          [cameras, by, from](Observations* repaired) { shift_cameras(cameras, by, from, repaired); }};
}

std::vector<Fault> camera_shift_faults(const Observations& observations, const std::vector<int>& cameras) {
  std::vector<Fault> faults;
  if (observations.cameras.size() < 2) return faults;  // the odometry's stamps would be shifted the other way
  for (const int c : cameras)
    for (const int by : {1, -1}) faults.push_back(shifted_frames(observations, {c}, by, 0));
  return faults;
}

Fault wrong_stop(const Observations& observations, int stop) {
  const double stamp_s = observations.stops[static_cast<std::size_t>(stop)].stamp_s;
  return {FaultKind::kStop, Finding("stop.contradicts", {{"stamp_s", stamp_s}}).at({stop}), false,
          [stop](Observations* repaired) { leave_out_stop(stop, repaired); }};
}

}  // namespace rigproof::ml
