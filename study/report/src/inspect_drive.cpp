#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "drive_poses.h"
#include "inspect_pictures.h"
#include "rigproof/core/conventions.h"

namespace rigproof::inspect_detail {
namespace {

constexpr double kMapWidth = 1120.0, kMapHeight = 820.0, kLegendWidth = 250.0;
constexpr double kFrustumLength = 0.45;  // metres on the ground
constexpr std::size_t kStopsWithFrusta = 6;
constexpr Color kOdometry{170, 60, 140};
constexpr Color kBoard{60, 60, 60};

using Point = Eigen::Vector2d;

// World metres to pixels: x to the right, y up, one scale for both.
class Map {
 public:
  explicit Map(const std::vector<Point>& points) {
    for (const Point& p : points) {
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
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

// What is drawn, in the world.
struct Drive {
  const InspectInput& input;
  std::vector<Rigid3> driven, odometry;  ///< robot poses at the stops; driven = odometry without truth
  std::vector<std::optional<Rigid3>> T_world_board;
  std::set<std::pair<int, std::size_t>> seen;  ///< (stop, camera) with a view of the board
  Map map;

  bool has_truth() const { return input.truth.has_value(); }
};

Drive drive_of(const InspectInput& input) {
  DrivePoses poses = drive_poses(input);
  std::set<std::pair<int, std::size_t>> seen;
  for (const BoardView& view : input.observations.board_views)
    seen.insert({view.stop, static_cast<std::size_t>(view.camera)});
  std::vector<Point> points;
  for (const auto* track : {&poses.driven, &poses.odometry})
    for (const Rigid3& T : *track) points.emplace_back(T.translation.head<2>());
  for (std::size_t b = 0; b < poses.T_world_board.size(); ++b)
    for (const Eigen::Vector3d& corner : input.observations.board_at(static_cast<int>(b)).outline())
      if (poses.T_world_board[b]) points.emplace_back((*poses.T_world_board[b] * corner).head<2>());
  return {input, std::move(poses.driven), std::move(poses.odometry), poses.T_world_board, std::move(seen), Map(points)};
}

void draw_grid(const Drive& drive, Canvas* canvas) {
  const double step = round_step(130.0 / drive.map.scale() * 1.001);
  const Point low = drive.map.unmap({kMargin, kTitleHeight + kMapHeight});
  const Point high = drive.map.unmap({kMargin + kMapWidth, kTitleHeight});
  for (double x = std::ceil(low.x() / step) * step; x <= high.x(); x += step) {
    canvas->line(drive.map(Point(x, low.y())), drive.map(Point(x, high.y())), kRule, 0.8);
    if (drive.map(Point(x, low.y())).x() < kMargin + kMapWidth - 45.0)
      canvas->text(drive.map(Point(x, low.y())) + Point(3.0, -5.0), number(step * std::round(x / step)) + " m", 7.5,
                   kGrey);
  }
  for (double y = std::ceil(low.y() / step) * step; y <= high.y(); y += step) {
    canvas->line(drive.map(Point(low.x(), y)), drive.map(Point(high.x(), y)), kRule, 0.8);
    canvas->text(drive.map(Point(low.x(), y)) + Point(4.0, -4.0), number(step * std::round(y / step)) + " m", 7.5,
                 kGrey);
  }
}

std::vector<Point> wedge(const Map& map, const Rigid3& T_world_camera, const Camera& camera, double length_m) {
  const Point apex = T_world_camera.translation.head<2>();
  std::vector<Point> points = {map(apex)};
  for (const double u : {0.0, camera.width_px - 1.0}) {
    Eigen::Vector3d ray;
    if (!camera.unproject({u, camera.cy_px}, &ray)) continue;
    const Point direction = (T_world_camera.rotation * ray).head<2>();
    points.push_back(map(Point(apex + length_m * direction.normalized())));
  }
  return points;
}

// Only cameras that see the board from here: what the drive is good for.
void draw_frusta(const Drive& drive, std::size_t stop, double opacity, Canvas* canvas) {
  for (std::size_t camera = 0; camera < drive.input.observations.cameras.size(); ++camera) {
    const RigCamera& rig_camera = drive.input.observations.cameras[camera];
    const auto T_robot_camera = camera_pose(drive.input, rig_camera.name);
    if (!T_robot_camera || drive.seen.count({static_cast<int>(stop), camera}) == 0) continue;
    canvas->polygon(wedge(drive.map, drive.driven[stop] * *T_robot_camera, rig_camera.camera, kFrustumLength),
                    camera_color(camera), opacity);
  }
}

// The way that was driven; with truth, from each stop to where odometry has it.
void draw_tracks(const Drive& drive, Canvas* canvas) {
  const double strength = drive.driven.size() > 40 ? 0.3 : 0.6;
  for (std::size_t i = 1; i < drive.driven.size(); ++i)
    canvas->line(drive.map(drive.driven[i - 1].translation), drive.map(drive.driven[i].translation),
                 kGrey.pale(strength), 1.0);
  for (std::size_t i = 0; drive.has_truth() && i < drive.odometry.size(); ++i) {
    canvas->line(drive.map(drive.driven[i].translation), drive.map(drive.odometry[i].translation), kOdometry, 1.2);
    canvas->disc(drive.map(drive.odometry[i].translation), 2.2, kOdometry);
  }
}

void draw_board(const Drive& drive, const Board& board, const Rigid3& T, const std::string& name, Canvas* canvas) {
  const std::vector<Eigen::Vector3d> outline = board.outline();
  const Eigen::Vector3d left = T * outline[0], right = T * outline[1];
  canvas->line(drive.map(left), drive.map(right), kBoard, 5.0);
  // The printed face looks along -z of the board.
  const Eigen::Vector3d middle = T * board.centre();
  const Eigen::Vector3d front = middle - 0.25 * (T.rotation * Eigen::Vector3d::UnitZ());
  canvas->line(drive.map(middle), drive.map(front), kBoard, 1.5);
  canvas->text(drive.map(right) + Point(8.0, 4.0), name, 8.5, kBoard);
}

void draw_boards(const Drive& drive, Canvas* canvas) {
  const Observations& observations = drive.input.observations;
  for (int b = 0; b < observations.boards(); ++b)
    if (const std::optional<Rigid3>& T = drive.T_world_board[static_cast<std::size_t>(b)])
      draw_board(drive, observations.board_at(b), *T,
                 observations.boards() == 1 ? "board" : "board " + std::to_string(b + 1), canvas);
}

// An arrow head; later stops are darker.
void draw_stop(const Drive& drive, std::size_t i, Canvas* canvas) {
  const double age =
      drive.driven.size() < 2 ? 1.0 : static_cast<double>(i) / static_cast<double>(drive.driven.size() - 1);
  const Point centre = drive.map(drive.driven[i].translation);
  const double heading = yaw_of(drive.driven[i]), size = drive.driven.size() > 60 ? 6.0 : 8.0;
  const auto at = [&](double angle, double radius) {
    return Point(centre + radius * Point(std::cos(heading + angle), -std::sin(heading + angle)));
  };
  const std::vector<Point> arrow = {at(0.0, size), at(2.5, size), at(kPi, 0.35 * size), at(-2.5, size)};
  canvas->polygon(arrow, kInk.pale(0.45 + 0.55 * age));
  canvas->polyline(arrow, kPaper, 0.5, true);
}

// Those of the first and the last stop come first; others only where they hide none.
void draw_numbers(const Drive& drive, Canvas* canvas) {
  constexpr double kHeight = 8.0, kBetween = 3.0;
  const std::size_t stops = drive.driven.size(), every = stops > 40 ? 10 : stops > 15 ? 5 : 1;
  std::vector<std::size_t> numbered = {0, stops - 1};
  for (std::size_t i = every; i + 1 < stops; i += every) numbered.push_back(i);
  std::vector<cv::Rect2d> taken;
  for (const std::size_t i : numbered) {
    const std::string text = std::to_string(i);
    const Point at = drive.map(drive.driven[i].translation) + Point(8.0, -7.0);
    const cv::Rect2d place(at.x(), at.y() - kHeight, Canvas::text_width(text, kHeight) + kBetween, kHeight + kBetween);
    if (std::any_of(taken.begin(), taken.end(), [&](const cv::Rect2d& other) { return (other & place).area() > 0.0; }))
      continue;
    canvas->text(at, text, kHeight, kInk);
    taken.push_back(place);
  }
}

// The rig at the first stop, cameras strong.
void draw_rig(const Drive& drive, Canvas* canvas) {
  if (drive.driven.empty()) return;
  for (std::size_t camera = 0; camera < drive.input.observations.cameras.size(); ++camera) {
    const RigCamera& rig_camera = drive.input.observations.cameras[camera];
    const auto T_robot_camera = camera_pose(drive.input, rig_camera.name);
    if (!T_robot_camera) continue;
    canvas->polyline(wedge(drive.map, drive.driven[0] * *T_robot_camera, rig_camera.camera, 1.2 * kFrustumLength),
                     camera_color(camera), 1.8, true);
  }
}

std::string summary(const Drive& drive) {
  double length = 0.0, turned = 0.0;
  for (std::size_t i = 1; i < drive.driven.size(); ++i) {
    length += (drive.driven[i].translation - drive.driven[i - 1].translation).norm();
    turned += std::abs(wrap_angle(yaw_of(drive.driven[i]) - yaw_of(drive.driven[i - 1])));
  }
  return std::to_string(drive.driven.size()) + " stops, " + number(length) + " m driven, " +
         number(rad_to_deg(turned)) + " deg turned" + (drive.has_truth() ? "" : "; poses by odometry");
}

void draw_legend(const Drive& drive, Canvas* canvas) {
  const double x = kMargin + kMapWidth + 24.0;
  double y = kTitleHeight + 14.0;
  constexpr double kHeight = 9.0, kIndent = 34.0, kWidth = kLegendWidth - kIndent;
  const auto entry = [&](const std::string& text) {
    canvas->text({x + kIndent, y}, text, kHeight, kInk);
    y += 26.0;
  };
  for (std::size_t camera = 0; camera < drive.input.observations.cameras.size(); ++camera) {
    canvas->polygon({{x, y - 4.0}, {x + 22.0, y - 13.0}, {x + 22.0, y + 5.0}}, camera_color(camera).pale(0.3));
    canvas->polyline({{x, y - 4.0}, {x + 22.0, y - 13.0}, {x + 22.0, y + 5.0}}, camera_color(camera), 1.5, true);
    std::size_t views = 0;
    for (const auto& [stop, seen_camera] : drive.seen) views += seen_camera == camera ? 1 : 0;
    const std::string& name = drive.input.observations.cameras[camera].name;
    const std::string count = "board in " + std::to_string(views);
    if (Canvas::text_width(name + ", " + count, kHeight) <= kWidth) {
      entry(name + ", " + count);
      continue;
    }
    entry(Canvas::shortened(name, kHeight, kWidth));
    y -= 10.0;
    entry(count);
  }
  y += 8.0;
  canvas->polygon({{x + 22.0, y - 4.0}, {x + 4.0, y - 10.0}, {x + 9.0, y - 4.0}, {x + 4.0, y + 2.0}}, kInk);
  entry(drive.has_truth() ? "true stop, heading" : "stop by odometry, heading");
  if (drive.T_world_board.front()) {
    canvas->line({x, y - 4.0}, {x + 24.0, y - 4.0}, kBoard, 5.0);
    entry(drive.has_truth() ? "board" : "board, from one view");
  }
  if (!drive.has_truth()) return;
  canvas->line({x, y - 4.0}, {x + 22.0, y - 4.0}, kOdometry, 1.2);
  canvas->disc({x + 22.0, y - 4.0}, 2.6, kOdometry);
  entry("stop by odometry");
  y += 8.0;
  canvas->text({x, y}, "end of odometry off by", 8.5, kGrey);
  const Rigid3 error = drive.driven.back().inverse() * drive.odometry.back();
  canvas->text({x, y + 18.0},
               number(100.0 * error.translation.head<2>().norm()) + " cm, " +
                   number(rad_to_deg(std::abs(yaw_of(error)))) + " deg",
               9.0, kInk);
}

}  // namespace

Written draw_drive(const InspectInput& input, const std::filesystem::path& folder) {
  if (input.observations.stops.empty()) return std::nullopt;
  const Drive drive = drive_of(input);
  const double height = kTitleHeight + kMapHeight + kMargin;
  Canvas canvas(static_cast<int>(2.0 * kMargin + kMapWidth + kLegendWidth), static_cast<int>(height));
  draw_grid(drive, &canvas);
  const std::size_t stops = drive.driven.size();
  // A few stops' frusta can be told apart, those of all cannot.
  const std::size_t shown = std::min(stops, kStopsWithFrusta);
  for (std::size_t k = 0; k < shown; ++k) draw_frusta(drive, k * stops / shown, 0.16, &canvas);
  draw_tracks(drive, &canvas);
  draw_boards(drive, &canvas);
  for (std::size_t i = 0; i < stops; ++i) draw_stop(drive, i, &canvas);
  draw_numbers(drive, &canvas);
  draw_rig(drive, &canvas);
  canvas.rectangle({kMargin + kMapWidth + 1.0, 0.0}, {kLegendWidth + kMargin, std::floor(height)}, kPaper);
  canvas.frame({kMargin, kTitleHeight}, {kMapWidth, kMapHeight}, kRule, 1.0);
  draw_title(&canvas, "The drive from above", summary(drive));
  draw_legend(drive, &canvas);
  return canvas.save(folder / "drive.png");
}

}  // namespace rigproof::inspect_detail
