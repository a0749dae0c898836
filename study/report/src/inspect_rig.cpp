#include "inspect_rig.h"

#include <algorithm>
#include <cmath>

#include "inspect_pictures.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/text.h"

namespace rigproof::inspect_detail {
namespace {

using Point = Eigen::Vector2d;

constexpr double kPanelWidth = 720.0, kPanelHeight = 560.0, kGap = 20.0, kRow = 24.0, kLetters = 9.5, kSwatch = 30.0;

// What is drawn.
struct RigDrawing {
  const InspectInput& input;
  MountedRig rig;
  double factor = 1.0;
  RigShapes shapes;

  const std::string& name(const MountedCamera& camera) const { return input.observations.cameras[camera.index].name; }
};

// Beside what it names, and not over another one.
class Labels {
 public:
  void add(Point at, const std::string& text, const Color& color, Canvas* canvas) {
    const Point size(Canvas::text_width(text, kLetters) + 6.0, kLetters + 5.0);
    const auto overlaps = [&](const Eigen::AlignedBox2d& other) {
      return !other.intersection(Eigen::AlignedBox2d(at, at + size)).isEmpty();
    };
    while (std::any_of(taken_.begin(), taken_.end(), overlaps)) at.y() += 2.0;
    taken_.emplace_back(at, at + size);
    canvas->polygon({at, at + Point(size.x(), 0.0), at + size, at + Point(0.0, size.y())}, kPaper, 0.7);
    canvas->text(at + Point(0.5 * size.x(), kLetters + 2.0), text, kLetters, color, Align::kCentre, true);
  }

 private:
  std::vector<Eigen::AlignedBox2d> taken_;
};

// Over everything, so that no body hides which way is forward.
void draw_axes(const SpaceView& view, const std::vector<Eigen::Vector3d>& tips, Labels* labels, Canvas* canvas) {
  static constexpr std::array<Color, 3> kAxes = {{{214, 69, 61}, {46, 154, 79}, {59, 111, 212}}};
  static constexpr std::array<const char*, 3> kNames = {"x, forward", "y, left", "z, up"};
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    canvas->line(view(Eigen::Vector3d::Zero()), view(tips[i]), kAxes[i], 2.2);
    labels->add(view(tips[i]) + Point(-20.0, -16.0), kNames[i], kAxes[i], canvas);
  }
}

void draw_names(const RigDrawing& drawing, const SpaceView& view, Labels* labels, Canvas* canvas) {
  const double length_m = frustum_length(drawing.rig);
  for (const MountedCamera& camera : drawing.rig.cameras) {
    if (!camera.is_known()) continue;
    const Rigid3 T = exaggerated(camera, drawing.factor);
    const Point beyond = view(T * Eigen::Vector3d(0.0, 0.0, 1.15 * length_m));
    labels->add(beyond - Point(0.5 * Canvas::text_width(drawing.name(camera), kLetters), 0.5 * kLetters),
                drawing.name(camera), camera_color(camera.index), canvas);
  }
}

void draw_view(const RigDrawing& drawing, const Eigen::Vector3d& towards_eye, const std::string& caption, double left,
               Canvas* canvas) {
  constexpr double kInside = 34.0;
  const Point corner(left, kTitleHeight), size(kPanelWidth, kPanelHeight), inside(kInside, kInside);
  const SpaceView view(towards_eye, drawing.shapes.seen(), corner + inside, size - 2.0 * inside);
  draw_shapes(drawing.shapes.ground, view, canvas);
  draw_shapes(drawing.shapes.solid, view, canvas);
  Labels labels;
  draw_axes(view, drawing.shapes.axes(), &labels, canvas);
  draw_names(drawing, view, &labels, canvas);
  canvas->frame(corner, size, kRule, 1.0);
  canvas->text(corner + Point(10.0, 20.0), caption, kLetters, kGrey);
}

std::string subtitle_of(const RigDrawing& drawing) {
  const bool has_sigma = std::any_of(drawing.rig.cameras.begin(), drawing.rig.cameras.end(),
                                     [](const MountedCamera& camera) { return camera.covariance.has_value(); });
  const bool is_estimated = !drawing.rig.method.empty(), has_truth = drawing.input.truth.has_value();
  std::vector<std::string> parts;
  if (is_estimated) parts.push_back("coloured: by " + drawing.rig.method);
  if (has_truth) parts.emplace_back("dashed: true");
  if (is_estimated && (has_truth || has_sigma))
    parts.push_back(std::string(has_truth ? "errors" : "") + (has_truth && has_sigma ? " and " : "") +
                    (has_sigma ? "2-sigma ellipsoids" : "") +
                    (drawing.factor > 1.0 ? " drawn " + number(drawing.factor) + " times too large" : " as they are"));
  parts.emplace_back("solid roof: upper side of the image");
  parts.push_back("squares of " + number(drawing.shapes.grid_m) + " m on the ground");
  if (drawing.shapes.stop) parts.push_back("robot at stop " + std::to_string(*drawing.shapes.stop));
  return joined(parts, "; ");
}

std::string error_text(const MountedCamera& camera) {
  if (!camera.T_true || !camera.T_estimate) return camera.T_true ? "true pose; not estimated" : "";
  const Vector6d error = transform_error(*camera.T_estimate, *camera.T_true);
  return number(1000.0 * error.head<3>().norm()) + " mm and " + number(rad_to_deg(error.tail<3>().norm())) +
         " deg from the truth";
}

// One line a camera: place, direction, and what strikes.
// @param left of what stands after the name
void draw_row(const RigDrawing& drawing, const MountedCamera& camera, double left, double y, Canvas* canvas) {
  const double middle = y - 0.5 * kLetters;
  canvas->polygon({{kMargin, middle}, {kMargin + 20.0, middle - 8.0}, {kMargin + 20.0, middle + 8.0}},
                  camera_color(camera.index));
  canvas->text({kMargin + kSwatch, y}, drawing.name(camera), kLetters, kInk, Align::kLeft, true);
  if (!camera.is_known()) return canvas->text({left, y}, "pose not answered completely", kLetters, kGrey);
  const Rigid3 T = camera.T_estimate.value_or(camera.best());
  const Eigen::Vector3d& p = T.translation;
  canvas->text({left, y},
               "x " + fixed_text(p.x(), 3) + "  y " + fixed_text(p.y(), 3) + "  z " + fixed_text(p.z(), 3) + " m",
               kLetters, kInk);
  canvas->text({left + 280.0, y}, looks(T), kLetters, kInk);
  canvas->text({left + 550.0, y}, unusual_roll(T), kLetters, kAccent, Align::kLeft, true);
  canvas->text({left + 700.0, y}, error_text(camera), kLetters,
               is_striking(camera, frustum_length(drawing.rig)) ? kAccent : kGrey);
}

// Of what stands after the names.
double left_of_rows(const RigDrawing& drawing) {
  double widest = 100.0;
  for (const MountedCamera& camera : drawing.rig.cameras)
    widest = std::max(widest, Canvas::text_width(drawing.name(camera), kLetters));
  return kMargin + kSwatch + widest + 30.0;
}

double width_of_rows(const RigDrawing& drawing) {
  double widest = 0.0;
  for (const MountedCamera& camera : drawing.rig.cameras)
    widest = std::max(widest, Canvas::text_width(error_text(camera), kLetters));
  return left_of_rows(drawing) + 700.0 + widest + kMargin;
}

void draw_rows(const RigDrawing& drawing, double top, Canvas* canvas) {
  double y = top;
  for (const MountedCamera& camera : drawing.rig.cameras)
    draw_row(drawing, camera, left_of_rows(drawing), y += kRow, canvas);
}

}  // namespace

Written draw_rig_in_space(const InspectInput& input, const std::filesystem::path& folder) {
  RigDrawing drawing{input, mounted_rig(input), 1.0, {}};
  const auto known = [](const MountedCamera& camera) { return camera.is_known(); };
  if (std::none_of(drawing.rig.cameras.begin(), drawing.rig.cameras.end(), known)) return std::nullopt;
  drawing.factor = exaggeration(drawing.rig);
  drawing.shapes = rig_shapes(input, drawing.rig, drawing.factor);
  const double bottom = kTitleHeight + kPanelHeight;
  Canvas canvas(static_cast<int>(std::max(2.0 * kMargin + 2.0 * kPanelWidth + kGap, width_of_rows(drawing))),
                static_cast<int>(bottom + kRow * (static_cast<double>(drawing.rig.cameras.size()) + 0.5) + kMargin));
  draw_title(&canvas, "The cameras on the robot", subtitle_of(drawing));
  draw_view(drawing, {1.0, 0.8, 0.75}, "from ahead, left and above", kMargin, &canvas);
  draw_view(drawing, {-1.0, -0.8, 0.75}, "from behind, right and above", kMargin + kPanelWidth + kGap, &canvas);
  draw_rows(drawing, bottom + 0.5 * kRow, &canvas);
  return canvas.save(folder / "rig.png");
}

}  // namespace rigproof::inspect_detail
