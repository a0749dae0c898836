#include "figure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rigproof/core/files.h"
#include "rigproof/core/pdf.h"

namespace rigproof::inspect_detail {
namespace {

constexpr double kPointsPerPixel = 0.75;
constexpr double kCapitalOfSize = 0.718;  // height of Helvetica's capitals
constexpr double kDash = 6.0;
// A quarter of a circle as a cubic curve.
constexpr double kQuarter = 0.5522847498;
// Opacities that the PDF knows, in steps of a twentieth.
constexpr int kOpacities = 20;

std::string numbers(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += pdf_number(value, 3) + " ";
  return text;
}

std::string color_of(const Color& color, const char* operation) {
  return numbers({color.r / 255.0, color.g / 255.0, color.b / 255.0}) + operation + " ";
}

std::string opacity_name(double opacity) {
  return "/G" + std::to_string(std::clamp(static_cast<int>(std::lround(opacity * kOpacities)), 0, kOpacities));
}

}  // namespace

void Figure::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Color& color, double thickness) {
  shapes_.push_back({Kind::kLine, {from, to}, color, thickness, 1.0, {}, Align::kLeft, false});
}

void Figure::dashed(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Color& color, double thickness) {
  shapes_.push_back({Kind::kDashed, {from, to}, color, thickness, 1.0, {}, Align::kLeft, false});
}

void Figure::polyline(const std::vector<Eigen::Vector2d>& points, const Color& color, double thickness) {
  if (points.size() < 2) return;
  shapes_.push_back({Kind::kPolyline, points, color, thickness, 1.0, {}, Align::kLeft, false});
}

void Figure::polygon(const std::vector<Eigen::Vector2d>& points, const Color& fill, double opacity) {
  if (points.size() < 3) return;
  shapes_.push_back({Kind::kPolygon, points, fill, 1.0, opacity, {}, Align::kLeft, false});
}

void Figure::disc(const Eigen::Vector2d& centre, double radius, const Color& fill) {
  shapes_.push_back({Kind::kDisc, {centre}, fill, radius, 1.0, {}, Align::kLeft, false});
}

void Figure::ring(const Eigen::Vector2d& centre, double radius, const Color& color, double thickness) {
  shapes_.push_back({Kind::kRing, {centre}, color, radius, thickness, {}, Align::kLeft, false});
}

void Figure::frame(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Color& color) {
  const Eigen::Vector2d across(size.x(), 0.0), down(0.0, size.y());
  polyline({corner, corner + across, corner + size, corner + down, corner}, color, 1.0);
}

void Figure::text(const Eigen::Vector2d& at, const std::string& words, double height, const Color& color, Align align,
                  bool bold) {
  shapes_.push_back({Kind::kText, {at}, color, height, 1.0, words, align, bold});
}

void Figure::title(const std::string& title, const std::string& subtitle) {
  text({kMargin, 32.0}, title, 13.0, kInk, Align::kLeft, true);
  text({kMargin, 54.0}, subtitle, 9.5, kGrey);
}

void Figure::draw(const Shape& shape, Canvas* canvas) const {
  switch (shape.kind) {
    case Kind::kLine:
      return canvas->line(shape.points[0], shape.points[1], shape.color, shape.size);
    case Kind::kDashed:
      return canvas->dashed(shape.points[0], shape.points[1], shape.color, shape.size, kDash);
    case Kind::kPolyline:
      return canvas->polyline(shape.points, shape.color, shape.size, false);
    case Kind::kPolygon:
      return canvas->polygon(shape.points, shape.color, shape.opacity);
    case Kind::kDisc:
      return canvas->disc(shape.points[0], shape.size, shape.color);
    case Kind::kRing:
      return canvas->ring(shape.points[0], shape.size, shape.color, shape.opacity);
    case Kind::kText:
      return canvas->text(shape.points[0], shape.words, shape.size, shape.color, shape.align, shape.bold);
  }
}

std::string Figure::operators(const Shape& shape) const {
  const auto at = [this](const Eigen::Vector2d& p, const char* operation) {
    return numbers({kPointsPerPixel * p.x(), kPointsPerPixel * (height_ - p.y())}) + operation + " ";
  };
  const auto path = [&] {
    std::string text = at(shape.points[0], "m");
    for (std::size_t i = 1; i < shape.points.size(); ++i) text += at(shape.points[i], "l");
    return text;
  };
  const auto circle = [&] {
    const Eigen::Vector2d c = shape.points[0];
    const double r = shape.size, k = kQuarter * r;
    const std::array<Eigen::Vector2d, 12> p = {
        {{r, k}, {k, r}, {0, r}, {-k, r}, {-r, k}, {-r, 0}, {-r, -k}, {-k, -r}, {0, -r}, {k, -r}, {r, -k}, {r, 0}}};
    std::string text = at(c + Eigen::Vector2d(r, 0.0), "m");
    for (std::size_t i = 0; i < p.size(); i += 3)
      text += at(c + p[i], "") + at(c + p[i + 1], "") + at(c + p[i + 2], "c");
    return text;
  };
  const auto stroke = [&](double thickness, const char* dash) {
    return "q 1 J 1 j " + std::string(dash) + color_of(shape.color, "RG") + numbers({kPointsPerPixel * thickness}) +
           "w ";
  };
  switch (shape.kind) {
    case Kind::kLine:
    case Kind::kPolyline:
      return stroke(shape.size, "") + path() + "S Q\n";
    case Kind::kDashed:
      return stroke(shape.size, "[4.5 4.5] 0 d 0 J ") + path() + "S Q\n";
    case Kind::kPolygon:
      return "q " + opacity_name(shape.opacity) + " gs " + color_of(shape.color, "rg") + path() + "f Q\n";
    case Kind::kDisc:
      return "q " + color_of(shape.color, "rg") + circle() + "f Q\n";
    case Kind::kRing:
      return stroke(shape.opacity, "") + circle() + "S Q\n";
    case Kind::kText:
      break;
  }
  const double size = kPointsPerPixel * shape.size / kCapitalOfSize;
  const double share = shape.align == Align::kLeft ? 0.0 : shape.align == Align::kCentre ? 0.5 : 1.0;
  const Eigen::Vector2d left =
      shape.points[0] - Eigen::Vector2d(share * size * helvetica_width(shape.words) / kPointsPerPixel, 0.0);
  return "BT " + color_of(shape.color, "rg") + (shape.bold ? "/F2 " : "/F1 ") + numbers({size}) + "Tf " +
         at(left, "Td") + pdf_string(shape.words) + " Tj ET\n";
}

std::string Figure::pdf() const {
  PdfPage page;
  page.width_pt = kPointsPerPixel * width_;
  page.height_pt = kPointsPerPixel * height_;
  page.resources = "/ExtGState << ";
  for (int i = 0; i <= kOpacities; ++i)
    page.resources += "/G" + std::to_string(i) + " << /ca " + pdf_number(static_cast<double>(i) / kOpacities) + " >> ";
  page.resources += ">> ";
  for (const Shape& shape : shapes_) page.operators += operators(shape);
  return pdf_document(page);
}

std::vector<std::filesystem::path> Figure::save(const std::filesystem::path& file_without_extension) const {
  Canvas canvas(width_, height_);
  for (const Shape& shape : shapes_) draw(shape, &canvas);
  const std::filesystem::path png = file_without_extension.string() + ".png";
  const std::filesystem::path vectors = file_without_extension.string() + ".pdf";
  canvas.save(png);
  write_file_atomically(vectors, pdf());
  return {png, vectors};
}

}  // namespace rigproof::inspect_detail
