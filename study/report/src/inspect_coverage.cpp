#include <algorithm>
#include <cmath>

#include "inspect_pictures.h"

namespace rigproof::inspect_detail {
namespace {

constexpr double kPanelWidth = 440.0, kGap = 26.0, kCaption = 44.0;
constexpr int kColumns = 3, kCellsAcross = 12;

// How many corners fell into each square cell of an image.
struct Grid {
  int columns = kCellsAcross, rows = 1;
  double cell_px = 1.0;
  std::vector<int> counts;

  explicit Grid(const Camera& camera)
      : rows(std::max(1, static_cast<int>(std::lround(kCellsAcross * static_cast<double>(camera.height_px) /
                                                      std::max(1, camera.width_px))))),
        cell_px(static_cast<double>(camera.width_px) / kCellsAcross),
        counts(static_cast<std::size_t>(columns * rows)) {}

  void add(const Eigen::Vector2d& pixel) {
    const int x = std::clamp(static_cast<int>((pixel.x() + 0.5) / cell_px), 0, columns - 1);
    const int y = std::clamp(static_cast<int>((pixel.y() + 0.5) / cell_px), 0, rows - 1);
    ++counts[static_cast<std::size_t>(y * columns + x)];
  }
  int largest() const { return *std::max_element(counts.begin(), counts.end()); }
  double filled() const {
    const auto empty = std::count(counts.begin(), counts.end(), 0);
    return 1.0 - static_cast<double>(empty) / static_cast<double>(counts.size());
  }
};

class CoveragePanel {
 public:
  CoveragePanel(const Observations& observations, std::size_t camera)
      : camera_(observations.cameras[camera]), color_(camera_color(camera)), grid_(camera_.camera) {
    for (const BoardView& view : observations.board_views) {
      if (view.camera != static_cast<int>(camera)) continue;
      views_.push_back(&view);
      for (const CornerObservation& corner : view.corners) grid_.add(corner.pixel);
    }
  }

  void draw(Canvas* canvas, const Eigen::Vector2d& origin) const {
    const double scale = kPanelWidth / camera_.camera.width_px;
    const Eigen::Vector2d size(kPanelWidth, height_at(kPanelWidth, camera_.camera));
    draw_cells(canvas, origin, size);
    std::size_t corners = 0;
    for (const BoardView* view : views_) {
      corners += view->corners.size();
      for (const CornerObservation& corner : view->corners)
        canvas->disc(origin + scale * (corner.pixel + Eigen::Vector2d(0.5, 0.5)), 1.3, color_);
    }
    canvas->frame(origin, size, color_, 1.5);
    canvas->text(origin + Eigen::Vector2d(0.0, size.y() + 17.0), camera_.name, 10.0, kInk, Align::kLeft, true);
    canvas->text(origin + Eigen::Vector2d(0.0, size.y() + 34.0),
                 std::to_string(views_.size()) + " views, " + std::to_string(corners) + " corners in " +
                     std::to_string(std::lround(100.0 * grid_.filled())) + " % of the cells",
                 8.5, kGrey);
  }

 private:
  void draw_cells(Canvas* canvas, const Eigen::Vector2d& origin, const Eigen::Vector2d& size) const {
    const int largest = std::max(1, grid_.largest());
    const Eigen::Vector2d cell(size.x() / grid_.columns, size.y() / grid_.rows);
    for (int y = 0; y < grid_.rows; ++y) {
      for (int x = 0; x < grid_.columns; ++x) {
        const int count = grid_.counts[static_cast<std::size_t>(y * grid_.columns + x)];
        if (count == 0) continue;
        // The square root keeps cells with few corners visible beside those with many.
        const double strength = 0.08 + 0.32 * std::sqrt(static_cast<double>(count) / largest);
        canvas->rectangle(origin + cell.cwiseProduct(Eigen::Vector2d(x, y)), cell, color_.pale(strength));
      }
    }
    for (int x = 1; x < grid_.columns; ++x)
      canvas->line(origin + Eigen::Vector2d(x * cell.x(), 0.0), origin + Eigen::Vector2d(x * cell.x(), size.y()), kRule,
                   0.5);
    for (int y = 1; y < grid_.rows; ++y)
      canvas->line(origin + Eigen::Vector2d(0.0, y * cell.y()), origin + Eigen::Vector2d(size.x(), y * cell.y()), kRule,
                   0.5);
  }

  const RigCamera& camera_;
  const Color color_;
  Grid grid_;
  std::vector<const BoardView*> views_;
};

}  // namespace

Written draw_coverage(const InspectInput& input, const std::filesystem::path& folder) {
  const Observations& observations = input.observations;
  if (observations.board_views.empty()) return std::nullopt;
  const int count = static_cast<int>(observations.cameras.size());
  const int columns = std::min(kColumns, count), rows = (count + columns - 1) / columns;
  double panel_height = 0.0;
  for (const RigCamera& camera : observations.cameras)
    panel_height = std::max(panel_height, height_at(kPanelWidth, camera.camera));
  const double width = 2.0 * kMargin + columns * (kPanelWidth + kGap) - kGap;
  const double height = kTitleHeight + rows * (panel_height + kCaption + kGap);
  Canvas canvas(static_cast<int>(std::max(width, 620.0)), static_cast<int>(height));
  draw_title(&canvas, "Where in the image corners were seen",
             "darker cells hold more corners; white cells tell nothing about the lens or the pose");
  for (int i = 0; i < count; ++i)
    CoveragePanel(observations, static_cast<std::size_t>(i))
        .draw(&canvas, {kMargin + (i % columns) * (kPanelWidth + kGap),
                        kTitleHeight + (i / columns) * (panel_height + kCaption + kGap)});
  return canvas.save(folder / "coverage.png");
}

}  // namespace rigproof::inspect_detail
