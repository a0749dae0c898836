#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "inspect_pictures.h"
#include "rigproof/calib/pnp.h"
#include "rigproof/core/conventions.h"

namespace rigproof::inspect_detail {
namespace {

constexpr double kMapWidth = 1120.0, kMapHeight = 820.0, kLegendWidth = 250.0;
constexpr double kFrustumLength = 0.45;  // metres on the ground
constexpr Color kOdometry{170, 60, 140};
constexpr Color kBoard{60, 60, 60};

using Point = Eigen::Vector2d;

Rigid3 odometry_pose(const Stop& stop) { return planar_pose(stop.x_m, stop.y_m, stop.yaw_rad); }

// World metres to pixels: x to the right, y up, one scale for both.
class Map {
 public:
  void include(const Point& p) {
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
  }
  void fit() {
    low_ -= Point(0.6, 0.6);
    high_ += Point(0.6, 0.6);
    scale_ = std::min(kMapWidth / (high_.x() - low_.x()), kMapHeight / (high_.y() - low_.y()));
    const Point used = scale_ * (high_ - low_);
    origin_ = Point(kMargin, kTitleHeight) + 0.5 * (Point(kMapWidth, kMapHeight) - used);
  }
  Point operator()(const Point& p) const {
    return {origin_.x() + scale_ * (p.x() - low_.x()), origin_.y() + scale_ * (high_.y() - p.y())};
  }
  Point operator()(const Eigen::Vector3d& p) const { return (*this)(Point(p.head<2>())); }
  double scale() const { return scale_; }
  // The world point at a corner of the map's area, not only of what was included.
  Point unmap(const Point& pixel) const {
    return {low_.x() + (pixel.x() - origin_.x()) / scale_, high_.y() - (pixel.y() - origin_.y()) / scale_};
  }

 private:
  Point low_ = Point::Constant(std::numeric_limits<double>::infinity()), high_ = -low_;
  Point origin_ = Point::Zero();
  double scale_ = 1.0;
};

class Drive {
 public:
  explicit Drive(const InspectInput& input) : input_(input), canvas_(width(), height()) {
    for (const Stop& stop : input.observations.stops) {
      odometry_.push_back(odometry_pose(stop));
      const auto T_world_robot = input.truth ? robot_at(*input.truth, stop.stamp_s) : std::nullopt;
      driven_.push_back(T_world_robot.value_or(odometry_.back()));
    }
    if (input.truth) align_odometry();
    find_board();
    for (const BoardView& view : input.observations.board_views)
      seen_.insert({view.stop, static_cast<std::size_t>(view.camera)});
  }

  void save(const std::filesystem::path& file) {
    prepare_map();
    draw_grid();
    for (std::size_t i = 0; i < driven_.size(); ++i) draw_frusta(i, driven_.size() > 40 ? 0.08 : 0.14);
    draw_tracks();
    draw_board();
    for (std::size_t i = 0; i < driven_.size(); ++i) draw_stop(i);
    draw_rig();
    canvas_.rectangle({kMargin + kMapWidth + 1.0, 0.0}, {kLegendWidth + kMargin, height() + 0.0}, kPaper);
    canvas_.frame({kMargin, kTitleHeight}, {kMapWidth, kMapHeight}, kRule, 1.0);
    draw_title(&canvas_, "The drive from above", summary());
    draw_legend();
    canvas_.save(file);
  }

 private:
  static int width() { return static_cast<int>(2.0 * kMargin + kMapWidth + kLegendWidth); }
  static int height() { return static_cast<int>(kTitleHeight + kMapHeight + kMargin); }
  bool has_truth() const { return input_.truth.has_value(); }

  // Odometry starts where it likes: its first pose is put on the truth's.
  void align_odometry() {
    const Rigid3 T_world_odom =
        planar_pose(driven_[0].translation.x(), driven_[0].translation.y(), yaw_of(driven_[0])) *
        odometry_[0].inverse();
    for (Rigid3& T : odometry_) T = T_world_odom * T;
  }

  void prepare_map() {
    for (const Rigid3& T : driven_) map_.include(T.translation.head<2>());
    for (const Rigid3& T : odometry_) map_.include(T.translation.head<2>());
    for (const Point& p : board_outline()) map_.include(p);
    map_.fit();
  }

  // Of the truth, or as the first view tells whose camera has a pose.
  void find_board() {
    if (has_truth()) {
      T_world_board_ = input_.truth->T_world_board;
      return;
    }
    for (const BoardView& view : input_.observations.board_views) {
      const RigCamera& camera = input_.observations.cameras[static_cast<std::size_t>(view.camera)];
      const auto T_robot_camera = camera_pose(input_, camera.name);
      if (!T_robot_camera) continue;
      const auto board = estimate_board_pose(view.corners, input_.observations.board, camera.camera);
      if (!board) continue;
      T_world_board_ = driven_[static_cast<std::size_t>(view.stop)] * *T_robot_camera * board->T_camera_board;
      return;
    }
  }

  std::vector<Point> board_outline() const {
    std::vector<Point> points;
    if (T_world_board_)
      for (const Eigen::Vector3d& corner : input_.observations.board.outline())
        points.emplace_back((*T_world_board_ * corner).head<2>());
    return points;
  }

  void draw_grid() {
    const double step = round_step(130.0 / map_.scale() * 1.001);
    const Point low = map_.unmap({kMargin, kTitleHeight + kMapHeight});
    const Point high = map_.unmap({kMargin + kMapWidth, kTitleHeight});
    for (double x = std::ceil(low.x() / step) * step; x <= high.x(); x += step) {
      canvas_.line(map_(Point(x, low.y())), map_(Point(x, high.y())), kRule, 0.8);
      if (map_(Point(x, low.y())).x() < kMargin + kMapWidth - 45.0)
        canvas_.text(map_(Point(x, low.y())) + Point(3.0, -5.0), number(step * std::round(x / step)) + " m", 7.5,
                     kGrey);
    }
    for (double y = std::ceil(low.y() / step) * step; y <= high.y(); y += step) {
      canvas_.line(map_(Point(low.x(), y)), map_(Point(high.x(), y)), kRule, 0.8);
      canvas_.text(map_(Point(low.x(), y)) + Point(4.0, -4.0), number(step * std::round(y / step)) + " m", 7.5, kGrey);
    }
  }

  std::vector<Point> wedge(const Rigid3& T_world_camera, const Camera& camera, double length_m) const {
    const Point apex = T_world_camera.translation.head<2>();
    std::vector<Point> points = {map_(apex)};
    for (const double u : {0.0, camera.width_px - 1.0}) {
      Eigen::Vector3d ray;
      if (!camera.unproject({u, camera.cy_px}, &ray)) continue;
      const Point direction = (T_world_camera.rotation * ray).head<2>();
      points.push_back(map_(Point(apex + length_m * direction.normalized())));
    }
    return points;
  }

  // Only cameras that see the board from here: what the drive is good for.
  void draw_frusta(std::size_t stop, double opacity) {
    for (std::size_t camera = 0; camera < input_.observations.cameras.size(); ++camera) {
      const RigCamera& rig_camera = input_.observations.cameras[camera];
      const auto T_robot_camera = camera_pose(input_, rig_camera.name);
      if (!T_robot_camera || seen_.count({static_cast<int>(stop), camera}) == 0) continue;
      canvas_.polygon(wedge(driven_[stop] * *T_robot_camera, rig_camera.camera, kFrustumLength), camera_color(camera),
                      opacity);
    }
  }

  void draw_tracks() {
    for (std::size_t i = 1; i < driven_.size(); ++i) {
      canvas_.line(map_(driven_[i - 1].translation), map_(driven_[i].translation), kGrey.pale(0.6), 1.0);
      if (has_truth())
        canvas_.dashed(map_(odometry_[i - 1].translation), map_(odometry_[i].translation), kOdometry, 1.0, 5.0);
    }
    if (!has_truth()) return;
    for (const Rigid3& T : odometry_) canvas_.disc(map_(T.translation), 2.2, kOdometry);
  }

  void draw_board() {
    if (!T_world_board_) return;
    const Rigid3& T = *T_world_board_;
    const std::vector<Eigen::Vector3d> outline = input_.observations.board.outline();
    const Eigen::Vector3d left = T * outline[0], right = T * outline[1];
    canvas_.line(map_(left), map_(right), kBoard, 5.0);
    // The printed face looks along -z of the board.
    const Eigen::Vector3d middle = T * input_.observations.board.centre();
    const Eigen::Vector3d front = middle - 0.25 * (T.rotation * Eigen::Vector3d::UnitZ());
    canvas_.line(map_(middle), map_(front), kBoard, 1.5);
    canvas_.text(map_(right) + Point(8.0, 4.0), "board", 8.5, kBoard);
  }

  // An arrow head; later stops are darker.
  void draw_stop(std::size_t i) {
    const double age = driven_.size() < 2 ? 1.0 : static_cast<double>(i) / static_cast<double>(driven_.size() - 1);
    const Point centre = map_(driven_[i].translation);
    const double heading = yaw_of(driven_[i]), size = driven_.size() > 60 ? 6.0 : 8.0;
    const auto at = [&](double angle, double radius) {
      return Point(centre + radius * Point(std::cos(heading + angle), -std::sin(heading + angle)));
    };
    const std::vector<Point> arrow = {at(0.0, size), at(2.5, size), at(kPi, 0.35 * size), at(-2.5, size)};
    canvas_.polygon(arrow, kInk.pale(0.45 + 0.55 * age));
    canvas_.polyline(arrow, kPaper, 0.5, true);
    const std::size_t every = driven_.size() > 40 ? 10 : driven_.size() > 15 ? 5 : 1;
    if (i % every == 0 || i + 1 == driven_.size())
      canvas_.text(centre + Point(8.0, -7.0), std::to_string(i), 8.0, kInk);
  }

  // The rig at the first stop, cameras strong.
  void draw_rig() {
    if (driven_.empty()) return;
    for (std::size_t camera = 0; camera < input_.observations.cameras.size(); ++camera) {
      const RigCamera& rig_camera = input_.observations.cameras[camera];
      const auto T_robot_camera = camera_pose(input_, rig_camera.name);
      if (!T_robot_camera) continue;
      canvas_.polyline(wedge(driven_[0] * *T_robot_camera, rig_camera.camera, 1.2 * kFrustumLength),
                       camera_color(camera), 1.8, true);
    }
  }

  std::string summary() const {
    double length = 0.0, turned = 0.0;
    for (std::size_t i = 1; i < driven_.size(); ++i) {
      length += (driven_[i].translation - driven_[i - 1].translation).norm();
      turned += std::abs(wrap_angle(yaw_of(driven_[i]) - yaw_of(driven_[i - 1])));
    }
    return std::to_string(driven_.size()) + " stops, " + number(length) + " m driven, " + number(rad_to_deg(turned)) +
           " deg turned" + (has_truth() ? "" : "; poses by odometry");
  }

  void draw_legend() {
    const double x = kMargin + kMapWidth + 24.0;
    double y = kTitleHeight + 14.0;
    const auto entry = [&](const std::string& text) {
      canvas_.text({x + 34.0, y}, text, 9.0, kInk);
      y += 26.0;
    };
    for (std::size_t camera = 0; camera < input_.observations.cameras.size(); ++camera) {
      canvas_.polygon({{x, y - 4.0}, {x + 22.0, y - 13.0}, {x + 22.0, y + 5.0}}, camera_color(camera).pale(0.3));
      canvas_.polyline({{x, y - 4.0}, {x + 22.0, y - 13.0}, {x + 22.0, y + 5.0}}, camera_color(camera), 1.5, true);
      std::size_t views = 0;
      for (const auto& [stop, seen_camera] : seen_) views += seen_camera == camera ? 1 : 0;
      entry(input_.observations.cameras[camera].name + ", board in " + std::to_string(views));
    }
    y += 8.0;
    canvas_.polygon({{x + 22.0, y - 4.0}, {x + 4.0, y - 10.0}, {x + 9.0, y - 4.0}, {x + 4.0, y + 2.0}}, kInk);
    entry(has_truth() ? "true stop, heading" : "stop by odometry, heading");
    if (T_world_board_) {
      canvas_.line({x, y - 4.0}, {x + 24.0, y - 4.0}, kBoard, 5.0);
      entry(has_truth() ? "board" : "board, from one view");
    }
    if (!has_truth()) return;
    canvas_.dashed({x, y - 4.0}, {x + 24.0, y - 4.0}, kOdometry, 1.2, 4.0);
    canvas_.disc({x + 12.0, y - 4.0}, 2.6, kOdometry);
    entry("odometry");
    y += 8.0;
    canvas_.text({x, y}, "end of odometry off by", 8.5, kGrey);
    const Rigid3 error = driven_.back().inverse() * odometry_.back();
    canvas_.text({x, y + 18.0},
                 number(100.0 * error.translation.head<2>().norm()) + " cm, " +
                     number(rad_to_deg(std::abs(yaw_of(error)))) + " deg",
                 9.0, kInk);
  }

  const InspectInput& input_;
  Canvas canvas_;
  Map map_;
  std::vector<Rigid3> driven_, odometry_;
  std::optional<Rigid3> T_world_board_;
  std::set<std::pair<int, std::size_t>> seen_;
};

}  // namespace

Written draw_drive(const InspectInput& input, const std::filesystem::path& folder) {
  if (input.observations.stops.empty()) return std::nullopt;
  Drive(input).save(folder / "drive.png");
  return folder / "drive.png";
}

}  // namespace rigproof::inspect_detail
