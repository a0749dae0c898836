#include <algorithm>

#include "inspect_pictures.h"

namespace rigproof::inspect_detail {
namespace {

constexpr double kThumbWidth = 400.0, kGap = 14.0, kCaption = 24.0;

// `count` views of a camera, spread over the drive.
std::vector<const BoardView*> spread_views(const Observations& observations, std::size_t camera, int count) {
  std::vector<const BoardView*> views;
  for (const BoardView& view : observations.board_views)
    if (view.camera == static_cast<int>(camera)) views.push_back(&view);
  const std::size_t wanted = static_cast<std::size_t>(std::max(1, count));
  if (views.size() <= wanted) return views;
  std::vector<const BoardView*> chosen;
  for (std::size_t i = 0; i < wanted; ++i) chosen.push_back(views[(2 * i + 1) * views.size() / (2 * wanted)]);
  return chosen;
}

class Mosaic {
 public:
  Mosaic(const InspectInput& input, const InspectOptions& options) : input_(input) {
    for (std::size_t camera = 0; camera < input.observations.cameras.size(); ++camera)
      rows_.push_back(spread_views(input.observations, camera, options.mosaic_views));
  }

  bool empty() const {
    return std::all_of(rows_.begin(), rows_.end(), [](const auto& row) { return row.empty(); });
  }

  std::filesystem::path save(const std::filesystem::path& file) const {
    std::size_t columns = 1;
    double height = kTitleHeight;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      columns = std::max(columns, rows_[row].size());
      height += row_height(row);
    }
    const double width = 2.0 * kMargin + static_cast<double>(columns) * (kThumbWidth + kGap) - kGap;
    Canvas canvas(static_cast<int>(std::max(width, 720.0)), static_cast<int>(height + kMargin));
    const double end =
        draw_title(&canvas, "Views with detected corners",
                   std::to_string(input_.observations.board_views.size()) + " views of the board at " +
                       std::to_string(input_.observations.stops.size()) + " stops; the first corner has a ring");
    draw_camera_legend(&canvas, camera_names(input_.observations), end, 32.0);
    double y = kTitleHeight;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      for (std::size_t i = 0; i < rows_[row].size(); ++i)
        draw_view(&canvas, *rows_[row][i], {kMargin + static_cast<double>(i) * (kThumbWidth + kGap), y});
      y += row_height(row);
    }
    return canvas.save(file);
  }

 private:
  double row_height(std::size_t row) const {
    return rows_[row].empty() ? 0.0 : height_at(kThumbWidth, input_.observations.cameras[row].camera) + kCaption + kGap;
  }

  void draw_view(Canvas* canvas, const BoardView& view, const Eigen::Vector2d& corner) const {
    const std::size_t index = static_cast<std::size_t>(view.camera);
    const RigCamera& camera = input_.observations.cameras[index];
    const Eigen::Vector2d size(kThumbWidth, height_at(kThumbWidth, camera.camera));
    const Color color = camera_color(index);
    const cv::Mat picture = draw_image(input_, view.file, corner, size, canvas);
    draw_corners_of(canvas, view, corner, kThumbWidth / camera.camera.width_px, color);
    if (!picture.empty()) draw_inset(canvas, view, picture, corner, size);
    canvas->frame(corner, size, color, 1.5);
    constexpr double kHeight = 8.5;
    std::string where = ", stop " + std::to_string(view.stop);
    if (const auto distance = distance_to_board(input_, view)) where += ", " + number(*distance) + " m";
    const double room = kThumbWidth - Canvas::text_width(where, kHeight);
    canvas->text(corner + Eigen::Vector2d(2.0, size.y() + 16.0), Canvas::shortened(camera.name, kHeight, room) + where,
                 kHeight, kInk);
  }

  // A board that is small in the image is shown again, larger, in the corner that is farthest from it.
  static void draw_inset(Canvas* canvas, const BoardView& view, const cv::Mat& picture, const Eigen::Vector2d& corner,
                         const Eigen::Vector2d& size) {
    if (view.corners.empty()) return;
    Eigen::Vector2d low = view.corners[0].pixel, high = low;
    for (const CornerObservation& c : view.corners) {
      low = low.cwiseMin(c.pixel);
      high = high.cwiseMax(c.pixel);
    }
    const Eigen::Vector2d middle = 0.5 * (low + high);
    const int side = static_cast<int>(1.8 * (high - low).maxCoeff());
    const cv::Rect crop =
        cv::Rect(static_cast<int>(middle.x()) - side / 2, static_cast<int>(middle.y()) - side / 2, side, side) &
        cv::Rect(0, 0, picture.cols, picture.rows);
    if (crop.width < 8 || crop.height < 8 || 3 * crop.width > picture.cols) return;
    const double scale = 0.5 * size.y() / std::max(crop.width, crop.height);
    const Eigen::Vector2d inset(scale * crop.width, scale * crop.height);
    const Eigen::Vector2d at(middle.x() < 0.5 * picture.cols ? size.x() - inset.x() - 6.0 : 6.0,
                             middle.y() < 0.5 * picture.rows ? size.y() - inset.y() - 6.0 : 6.0);
    canvas->image(picture(crop), corner + at, inset);
    draw_corners_of(canvas, view, corner + at - scale * Eigen::Vector2d(crop.x, crop.y), scale,
                    camera_color(static_cast<std::size_t>(view.camera)));
    canvas->frame(corner + at, inset, kPaper, 2.0);
  }

  static void draw_corners_of(Canvas* canvas, const BoardView& view, const Eigen::Vector2d& origin, double scale,
                              const Color& color) {
    std::vector<Eigen::Vector2d> points;
    for (const CornerObservation& c : view.corners)
      points.push_back(origin + scale * (c.pixel + Eigen::Vector2d(0.5, 0.5)));
    if (points.empty()) return;
    canvas->polyline(points, kPaper, 2.2, false);
    canvas->polyline(points, color, 1.0, false);
    for (std::size_t i = 0; i < points.size(); ++i) {
      canvas->disc(points[i], 2.8, kPaper);
      canvas->disc(points[i], 1.9, color);
      if (view.corners[i].id == 0) canvas->ring(points[i], 6.5, kAccent, 1.6);
    }
  }

  const InspectInput& input_;
  std::vector<std::vector<const BoardView*>> rows_;
};

}  // namespace

Written draw_mosaic(const InspectInput& input, const InspectOptions& options, const std::filesystem::path& folder) {
  const Mosaic mosaic(input, options);
  if (mosaic.empty()) return std::nullopt;
  return mosaic.save(folder / "mosaic.png");
}

}  // namespace rigproof::inspect_detail
