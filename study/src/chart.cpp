#include "chart.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace rigproof::inspect_detail {
namespace {

constexpr double kLabel = 8.0;  // height of letters at the axes

double share(double value, double low, double high, bool log) {
  if (!log) return (value - low) / (high - low);
  return std::log(std::max(value, 1e-300) / low) / std::log(high / low);
}

// Stretches of a series where everything that is needed has a value.
template <typename Visit>
void for_each_stretch(const std::vector<std::optional<double>>& y, const Visit& visit) {
  for (std::size_t begin = 0; begin < y.size();) {
    std::size_t end = begin;
    while (end < y.size() && y[end]) ++end;
    if (end > begin) visit(begin, end);
    begin = end + 1;
  }
}

void draw_mark(const Eigen::Vector2d& place, double radius, const Series& series, Figure* figure) {
  if (!series.hollow) return figure->disc(place, radius, series.color);
  figure->disc(place, radius, kPaper);
  figure->ring(place, radius, series.color);
}

// "1e-5" where zeros would reach into the next chart's labels, or be cut off.
std::string tick_text(double value, bool log_axis) {
  const double plain_from = log_axis ? 0.99e-2 : 0.99e-3;
  const bool plain = value <= 0.0 || (value > plain_from && !(log_axis && value > 9999.0));
  if (plain) return number(value);
  const int power = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  return number(value / std::pow(10.0, power)) + "e" + std::to_string(power);
}

// Every n-th label is written so that none touches the next.
std::size_t label_stride(const ChartAxes& axes, const std::vector<double>& places) {
  constexpr double kBetween = 6.0;
  double widest = 0.0;
  for (const double x : places) widest = std::max(widest, Canvas::text_width(tick_text(x, axes.x_log), kLabel));
  if (places.size() < 2) return 1;
  const double first = axes.at(places.front(), axes.y_low).x(), last = axes.at(places.back(), axes.y_low).x();
  const double step = (last - first) / static_cast<double>(places.size() - 1);
  return static_cast<std::size_t>(std::max(1.0, std::ceil((widest + kBetween) / std::max(step, 1e-3))));
}

}  // namespace

Eigen::Vector2d ChartAxes::at(double x, double y) const {
  const double u = std::clamp(share(x, x_low, x_high, x_log), 0.0, 1.0);
  const double v = std::clamp(share(y, y_low, y_high, y_log), 0.0, 1.0);
  return {left + width * u, top + height * (1.0 - v)};
}

std::vector<double> ticks(double low, double high, bool log) {
  std::vector<double> places;
  if (log) {
    const bool fine = high / low < 30.0;
    for (int power = static_cast<int>(std::floor(std::log10(low) + 1e-9)); std::pow(10.0, power) <= high * 1.0001;
         ++power)
      for (const double leading : {1.0, 2.0, 5.0}) {
        const double place = leading * std::pow(10.0, power);
        if ((leading == 1.0 || fine) && place >= low * 0.9999 && place <= high * 1.0001) places.push_back(place);
      }
    return places;
  }
  const double step = round_step((high - low) / 4.0);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1.0) places.push_back(k * step);
  return places;
}

void decades_around(const std::vector<double>& values, double* low, double* high) {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const double value : values) {
    if (!(value > 0.0) || !std::isfinite(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  if (!(most > 0.0)) least = most = 1.0;
  *low = std::pow(10.0, std::floor(std::log10(least) - 1e-9));
  *high = std::pow(10.0, std::ceil(std::log10(most) + 1e-9));
}

void draw_axes(const ChartAxes& axes, const ChartLabels& labels, Figure* figure) {
  const double bottom = axes.top + axes.height, right = axes.left + axes.width;
  for (const double y : ticks(axes.y_low, axes.y_high, axes.y_log)) {
    const Eigen::Vector2d p = axes.at(axes.x_low, y);
    figure->line(p, {right, p.y()}, kRule);
    if (labels.y_numbers)
      figure->text({axes.left - 6.0, p.y() + 3.0}, tick_text(y, axes.y_log), kLabel, kGrey, Align::kRight);
  }
  const std::vector<double> places = ticks(axes.x_low, axes.x_high, axes.x_log);
  const std::size_t stride = label_stride(axes, places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector2d p = axes.at(places[i], axes.y_low);
    figure->line(p, {p.x(), axes.top}, kRule);
    if (i % stride == 0)
      figure->text({p.x(), bottom + 15.0}, tick_text(places[i], axes.x_log), kLabel, kGrey, Align::kCentre);
  }
  figure->frame({axes.left, axes.top}, {axes.width, axes.height}, kGrey);
  figure->text({axes.left, axes.top - 8.0}, labels.title, 9.0, kInk, Align::kLeft, true);
  if (!labels.y.empty()) figure->text({right, axes.top - 8.0}, labels.y, kLabel, kGrey, Align::kRight);
  figure->text({right, bottom + 30.0}, labels.x, kLabel, kGrey, Align::kRight);
}

void draw_series(const ChartAxes& axes, const Series& series, Figure* figure) {
  constexpr double kBand = 0.15;
  for_each_stretch(series.low, [&](std::size_t begin, std::size_t end) {
    std::vector<Eigen::Vector2d> band;
    for (std::size_t i = begin; i < end; ++i) band.push_back(axes.at(series.x[i], series.low[i].value()));
    for (std::size_t i = end; i-- > begin;) band.push_back(axes.at(series.x[i], series.high[i].value()));
    figure->polygon(band, series.color, kBand);
  });
  for_each_stretch(series.y, [&](std::size_t begin, std::size_t end) {
    std::vector<Eigen::Vector2d> line;
    for (std::size_t i = begin; i < end; ++i) line.push_back(axes.at(series.x[i], series.y[i].value()));
    figure->polyline(line, series.color, series.hollow ? 1.0 : 1.8);
    for (const Eigen::Vector2d& place : line) draw_mark(place, 2.2, series, figure);
  });
}

void draw_legend(const std::vector<Series>& series, const Eigen::Vector2d& at, Figure* figure) {
  constexpr double kHeight = 9.0, kLine = 18.0;
  Eigen::Vector2d place = at;
  for (const Series& entry : series) {
    const double width = Canvas::text_width(entry.name, kHeight) + 34.0;
    if (place.x() + width > figure->width() - kMargin && place.x() > at.x()) place = {at.x(), place.y() + kLine};
    draw_mark(place + Eigen::Vector2d(4.0, -0.5 * kHeight), 4.5, entry, figure);
    figure->text(place + Eigen::Vector2d(14.0, 0.0), entry.name, kHeight, kInk);
    place.x() += width;
  }
}

}  // namespace rigproof::inspect_detail
