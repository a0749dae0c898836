#include <algorithm>
#include <cmath>

#include "inspect_pictures.h"
#include "rigproof/core/conventions.h"

namespace rigproof::inspect_detail {
namespace {

using Point = Eigen::Vector2d;

constexpr double kPlaneWidth = 860.0, kSide = 320.0, kGap = 40.0, kHistogramHeight = 120.0;

struct Statistics {
  Point bias = Point::Zero(), rms = Point::Zero();
  double max = 0.0, typical = 0.0;  // typical: 95 % of the distances are smaller
};

Statistics statistics_of(const std::vector<Residual>& residuals) {
  Statistics s;
  std::vector<double> distances;
  for (const Residual& r : residuals) {
    s.bias += r.difference;
    s.rms += r.difference.cwiseAbs2();
    distances.push_back(r.difference.norm());
  }
  const double n = static_cast<double>(residuals.size());
  s.bias /= n;
  s.rms = (s.rms / n).cwiseSqrt();
  std::sort(distances.begin(), distances.end());
  s.max = distances.back();
  s.typical = distances[static_cast<std::size_t>(0.95 * (n - 1.0))];
  return s;
}

class ResidualDrawing {
 public:
  explicit ResidualDrawing(const ResidualPicture& picture)
      : picture_(picture),
        statistics_(statistics_of(picture.residuals)),
        plane_height_(height_at(kPlaneWidth, picture.image)),
        side_height_(kSide + 2.0 * (kHistogramHeight + kGap + 8.0)),
        // The side plots hold nearly all of what is typical, and two of the stated sigmas.
        range_px_(round_up(std::max({1e-6, 1.3 * statistics_.typical, 2.5 * picture.stated_sigma_px}))) {}

  std::filesystem::path save(const std::filesystem::path& file) const {
    Canvas canvas(static_cast<int>(2.0 * kMargin + kPlaneWidth + kGap + kSide),
                  static_cast<int>(kTitleHeight + std::max(plane_height_ + 92.0, side_height_) + kMargin));
    draw_title(&canvas, picture_.title, picture_.subtitle);
    draw_plane(&canvas);
    draw_facts(&canvas);
    draw_scatter(&canvas);
    draw_histogram(0, kTitleHeight + kSide + kGap, &canvas);
    draw_histogram(1, kTitleHeight + kSide + 2.0 * kGap + kHistogramHeight + 8.0, &canvas);
    return canvas.save(file);
  }

 private:
  Color color() const { return camera_color(picture_.camera); }

  void draw_plane(Canvas* canvas) const {
    const Point origin(kMargin, kTitleHeight);
    const double scale = kPlaneWidth / picture_.image.width_px;
    canvas->rectangle(origin, {kPlaneWidth, plane_height_}, Color{250, 250, 251});
    const double target = 26.0;  // a typical arrow's length in the picture
    const double magnified = round_step(target / std::max(1e-9, scale * statistics_.typical));
    for (const Residual& r : picture_.residuals) {
      const Point from = origin + scale * (r.pixel + Point(0.5, 0.5));
      Point arrow = scale * magnified * r.difference;
      if (arrow.norm() > 4.0 * target) arrow *= 4.0 * target / arrow.norm();
      canvas->line(from, from + arrow, color().pale(0.75), 0.9);
      canvas->disc(from, 1.3, kInk);
    }
    canvas->frame(origin, {kPlaneWidth, plane_height_}, kGrey, 1.0);
    draw_scale_bar(origin + Point(0.0, plane_height_ + 22.0), scale * magnified, magnified, canvas);
  }

  static void draw_scale_bar(const Point& at, double pixels_per_px, double magnified, Canvas* canvas) {
    const double shown = round_step(90.0 / pixels_per_px);
    const double length = shown * pixels_per_px;
    canvas->line(at, at + Point(length, 0.0), kInk, 2.0);
    for (const double x : {0.0, length}) canvas->line(at + Point(x, -4.0), at + Point(x, 4.0), kInk, 1.5);
    canvas->text(at + Point(length + 10.0, 4.0),
                 number(shown) + " px (arrows magnified " + number(magnified) + " times)", 8.5, kInk);
  }

  void draw_facts(Canvas* canvas) const {
    const Statistics& s = statistics_;
    const std::string text = "mean " + number(s.bias.x()) + ", " + number(s.bias.y()) + " px   rms " +
                             number(s.rms.x()) + ", " + number(s.rms.y()) + " px   largest " + number(s.max) + " px";
    const Point at(kMargin, kTitleHeight + plane_height_ + 52.0);
    canvas->text(at, text, 9.5, kInk);
    if (picture_.stated_sigma_px > 0.0)
      canvas->text(at + Point(0.0, 22.0),
                   "expected " + number(picture_.stated_sigma_px) + " px; the rms is " +
                       number(picture_.rms_over_stated()) + " times that",
                   9.5, kInk);
  }

  double side_x() const { return kMargin + kPlaneWidth + kGap; }

  void draw_scatter(Canvas* canvas) const {
    const Point origin(side_x(), kTitleHeight), centre = origin + Point(0.5 * kSide, 0.5 * kSide);
    const double scale = 0.5 * kSide / range_px_;
    const double step = round_step(0.6 * range_px_);
    for (double value = -std::floor(range_px_ / step) * step; value <= range_px_; value += step) {
      canvas->line({centre.x() + scale * value, origin.y()}, {centre.x() + scale * value, origin.y() + kSide}, kRule,
                   0.7);
      canvas->line({origin.x(), centre.y() + scale * value}, {origin.x() + kSide, centre.y() + scale * value}, kRule,
                   0.7);
    }
    canvas->line({centre.x(), origin.y()}, {centre.x(), origin.y() + kSide}, kGrey, 0.8);
    canvas->line({origin.x(), centre.y()}, {origin.x() + kSide, centre.y()}, kGrey, 0.8);
    std::size_t outside = 0;
    for (const Residual& r : picture_.residuals) {
      if (r.difference.cwiseAbs().maxCoeff() > range_px_)
        ++outside;
      else
        canvas->disc(centre + scale * r.difference, 1.6, color());
    }
    if (picture_.stated_sigma_px > 0.0) canvas->ring(centre, scale * picture_.stated_sigma_px, kInk, 1.4);
    canvas->frame(origin, {kSide, kSide}, kGrey, 1.0);
    canvas->text(origin + Point(0.0, kSide + 15.0), "u right, v down; grid " + number(step) + " px", 8.0, kGrey);
    if (outside > 0)
      canvas->text(origin + Point(8.0, kSide - 8.0), std::to_string(outside) + " beyond " + number(range_px_) + " px",
                   8.0, kAccent);
  }

  void draw_histogram(Eigen::Index axis, double top, Canvas* canvas) const {
    constexpr int kBins = 41;
    std::vector<int> counts(kBins);
    for (const Residual& r : picture_.residuals) {
      const double position = (r.difference[axis] / range_px_ + 1.0) / 2.0 * kBins;
      if (position >= 0.0 && position < kBins) ++counts[static_cast<std::size_t>(position)];
    }
    const double highest = std::max<double>(*std::max_element(counts.begin(), counts.end()), stated_in_middle(kBins));
    const double bin = kSide / kBins, bottom = top + kHistogramHeight, usable = 0.9 * kHistogramHeight;
    for (int i = 0; i < kBins; ++i) {
      const double height = usable * counts[static_cast<std::size_t>(i)] / highest;
      canvas->rectangle({side_x() + i * bin + 0.5, bottom - height}, {bin - 1.0, height}, color().pale(0.7));
    }
    draw_stated_curve(top, usable / highest, canvas);
    canvas->line({side_x(), bottom}, {side_x() + kSide, bottom}, kGrey, 1.0);
    canvas->line({side_x() + 0.5 * kSide, top}, {side_x() + 0.5 * kSide, bottom}, kGrey, 0.8);
    canvas->text({side_x() + 2.0, top + 12.0}, axis == 0 ? "u" : "v", 10.0, kInk, Align::kLeft, true);
    canvas->text({side_x(), bottom + 16.0}, number(-range_px_), 8.0, kGrey);
    canvas->text({side_x() + 0.5 * kSide, bottom + 16.0}, "0", 8.0, kGrey, Align::kCentre);
    canvas->text({side_x() + kSide, bottom + 16.0}, number(range_px_) + " px", 8.0, kGrey, Align::kRight);
  }

  // How many the stated sigma predicts for the middle one of so many bins; 1 at least.
  double stated_in_middle(int bins) const {
    const double sigma = picture_.stated_sigma_px;
    const double per_bin = static_cast<double>(picture_.residuals.size()) * (2.0 * range_px_ / bins);
    return sigma > 0.0 ? std::max(1.0, per_bin / (sigma * std::sqrt(2.0 * kPi))) : 1.0;
  }

  // What the stated sigma predicts for these bins.
  void draw_stated_curve(double top, double height_per_count, Canvas* canvas) const {
    const double sigma = picture_.stated_sigma_px;
    if (!(sigma > 0.0)) return;
    constexpr int kBins = 41, kPoints = 160;
    const double per_bin = static_cast<double>(picture_.residuals.size()) * (2.0 * range_px_ / kBins);
    std::vector<Point> curve;
    for (int i = 0; i <= kPoints; ++i) {
      const double value = range_px_ * (2.0 * i / kPoints - 1.0);
      const double density = std::exp(-0.5 * value * value / (sigma * sigma)) / (sigma * std::sqrt(2.0 * kPi));
      const double height = height_per_count * per_bin * density;
      curve.emplace_back(side_x() + kSide * i / kPoints, top + kHistogramHeight - height);
    }
    canvas->polyline(curve, kInk, 1.2, false);
  }

  const ResidualPicture& picture_;
  const Statistics statistics_;
  const double plane_height_, side_height_;
  const double range_px_;
};

}  // namespace

double ResidualPicture::rms_over_stated() const {
  return std::sqrt(0.5 * statistics_of(residuals).rms.squaredNorm()) / stated_sigma_px;
}

std::filesystem::path draw_residuals(const ResidualPicture& picture, const std::filesystem::path& file) {
  return ResidualDrawing(picture).save(file);
}

Written draw_corners(const InspectInput& input, std::size_t camera, const std::filesystem::path& folder) {
  if (!input.truth) return std::nullopt;
  const Truth& truth = *input.truth;
  const std::string& name = input.observations.cameras[camera].name;
  const auto true_camera = index_in_truth(truth, name);
  if (!true_camera) return std::nullopt;
  ResidualPicture picture;
  picture.camera = camera;
  picture.image = truth.cameras[*true_camera].camera;
  const std::vector<TrueStop>& stops = truth.stops_of(*true_camera);
  std::size_t views = 0;
  double variance = 0.0;
  for (const BoardView& view : input.observations.board_views) {
    const auto stop = stop_at(stops, view.stamp_s);
    if (view.camera != static_cast<int>(camera) || view.board >= truth.boards() || !stop) continue;
    ++views;
    const TrueBoard& board = truth.board_at(view.board);
    for (const CornerObservation& corner : view.corners) {
      Eigen::Vector2d projected;
      if (!truth.project_corner(*true_camera, stops[*stop], board, corner.id, corner.pixel.y(), &projected)) continue;
      picture.residuals.push_back({corner.pixel, corner.pixel - projected});
      variance += 0.5 * corner.covariance_px2.trace();
    }
  }
  if (picture.residuals.empty()) return std::nullopt;
  picture.stated_sigma_px = std::sqrt(variance / static_cast<double>(picture.residuals.size()));
  picture.title = name + ": detected minus true corners";
  picture.subtitle = std::to_string(picture.residuals.size()) + " corners in " + std::to_string(views) +
                     " views; ring and curve: the detector's stated sigma";
  return draw_residuals(picture, folder / ("corners_" + name + ".png"));
}

ResidualPicture fitted_corners(const Observations& observations, const Result& result, const CornerFit& fit,
                               std::size_t camera) {
  const RigCamera& rig_camera = observations.cameras[camera];
  ResidualPicture picture;
  picture.camera = camera;
  picture.image = rig_camera.camera;
  std::size_t views = 0;
  double variance = 0.0;
  for (std::size_t i = 0; i < observations.board_views.size(); ++i) {
    const BoardView& view = observations.board_views[i];
    const std::vector<Point>& differences = fit.differences[i];
    if (view.camera != static_cast<int>(camera) || differences.empty()) continue;
    ++views;
    for (std::size_t c = 0; c < differences.size(); ++c) {
      if (!differences[c].allFinite()) continue;
      picture.residuals.push_back({view.corners[c].pixel, differences[c]});
      variance += 0.5 * view.corners[c].covariance_px2.trace();
    }
  }
  const double count = static_cast<double>(std::max<std::size_t>(1, picture.residuals.size()));
  const double detector = fit.shrink() * std::sqrt(variance / count);
  picture.stated_sigma_px = std::hypot(detector, rig_camera.intrinsics_sigma.residual_px);
  picture.title = result.method + ", " + rig_camera.name + ": detected minus fitted corners";
  picture.subtitle = std::to_string(picture.residuals.size()) + " corners in " + std::to_string(views) +
                     " views; a stop's board fitted to all cameras; ring and curve: what detector and lens let expect";
  return picture;
}

Written draw_fitted_corners(const InspectInput& input, const Result& result, const CornerFit& fit, std::size_t camera,
                            const std::filesystem::path& folder) {
  const std::string& name = input.observations.cameras[camera].name;
  const ResidualPicture picture = fitted_corners(input.observations, result, fit, camera);
  if (pose_of_camera(result, name) == nullptr || picture.residuals.empty()) return std::nullopt;
  return draw_residuals(picture, folder / ("corners_" + result.method + "_" + name + ".png"));
}

}  // namespace rigproof::inspect_detail
