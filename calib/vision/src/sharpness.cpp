#include "rigproof/calib/vision/sharpness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rigproof/core/board_markers.h"
#include "rigproof/core/median.h"
#include "saddle_fit.h"

namespace rigproof {
namespace {

const CornerObservation* find_corner(const std::vector<CornerObservation>& corners, int id) {
  const auto found = std::find_if(corners.begin(), corners.end(), [id](const auto& corner) { return corner.id == id; });
  return found == corners.end() ? nullptr : &*found;
}

// To the nearer neighbour along a row (step 1) or a column (step of a row); absent without any.
std::optional<Eigen::Vector2d> square_along(const std::vector<CornerObservation>& corners,
                                            const CornerObservation& corner, int step, bool has_next, bool has_last) {
  const CornerObservation* next = has_next ? find_corner(corners, corner.id + step) : nullptr;
  const CornerObservation* last = has_last ? find_corner(corners, corner.id - step) : nullptr;
  if (next == nullptr && last == nullptr) return std::nullopt;
  if (next == nullptr) return corner.pixel - last->pixel;
  if (last == nullptr) return next->pixel - corner.pixel;
  const Eigen::Vector2d ahead = next->pixel - corner.pixel, behind = corner.pixel - last->pixel;
  return ahead.norm() < behind.norm() ? ahead : behind;
}

}  // namespace

std::optional<double> edge_width_px(const Image8& grey, const Board& board,
                                    const std::vector<CornerObservation>& corners) {
  const int columns = board.inner_corners_x(), rows = board.inner_corners_y();
  std::vector<double> widths;
  for (const CornerObservation& corner : corners) {
    const int x = corner.id % columns, y = corner.id / columns;
    // Of an AprilGrid across the gap: a tag is clean as far as its border goes, two thirds of that.
    const bool tags = board.has_tags();
    const auto across =
        square_along(corners, corner, 1, x + 1 < columns && !(tags && x % 2 == 0), x > 0 && !(tags && x % 2 == 1));
    const auto down =
        square_along(corners, corner, columns, y + 1 < rows && !(tags && y % 2 == 0), y > 0 && !(tags && y % 2 == 1));
    if (!across || !down) continue;
    detection::SaddleWindow window;
    window.centre = corner.pixel;
    window.square << *across, *down;
    if (tags) window.square *= 2.0 / 3.0;
    window.dark_diagonal = board.is_dark(x, y);
    window.marker_share = board.type == "charuco" ? board.marker_side_m() / board.square_m : 0.0;
    const detection::SaddleFit fit = detection::fit_saddle(grey, window);
    if (fit.status == detection::SaddleStatus::kFitted) widths.push_back(2.0 * fit.blur_px.maxCoeff());
  }
  if (widths.empty()) return std::nullopt;
  return median(std::move(widths));
}

Exposure exposure_of(const Image8& grey, const std::vector<CornerObservation>& corners) {
  constexpr int kWhite = 253, kDark = 60;
  constexpr double kBrightest = 0.05;
  int x0 = 0, y0 = 0, x1 = grey.width - 1, y1 = grey.height - 1;
  if (!corners.empty()) {
    Eigen::Vector2d low = corners.front().pixel, high = low;
    for (const CornerObservation& corner : corners) {
      low = low.cwiseMin(corner.pixel);
      high = high.cwiseMax(corner.pixel);
    }
    x0 = std::clamp(static_cast<int>(low.x()), 0, x1);
    y0 = std::clamp(static_cast<int>(low.y()), 0, y1);
    x1 = std::clamp(static_cast<int>(high.x()), x0, x1);
    y1 = std::clamp(static_cast<int>(high.y()), y0, y1);
  }
  double white = 0.0, light = 0.0;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      white += grey.at(x, y) >= kWhite;
      light += grey.at(x, y) > kDark;
    }
  const double pixels = static_cast<double>(x1 - x0 + 1) * (y1 - y0 + 1);
  if (white > (corners.empty() ? 0.5 : 0.25) * pixels) return Exposure::kOver;
  return light < kBrightest * pixels ? Exposure::kUnder : Exposure::kGood;
}

}  // namespace rigproof
