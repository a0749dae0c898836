// A figure that is kept as what is drawn, so that it can be written as pixels and as vectors.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "inspect_canvas.h"

namespace rigproof::inspect_detail {

/// Coordinates are pixels of the PNG, y down; in the PDF one is 3/4 of a point.
class Figure {
 public:
  Figure(int width, int height) : width_(width), height_(height) {}
  int width() const { return width_; }
  int height() const { return height_; }

  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Color& color, double thickness = 1.0);
  void dashed(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Color& color, double thickness = 1.0);
  void polyline(const std::vector<Eigen::Vector2d>& points, const Color& color, double thickness);
  void polygon(const std::vector<Eigen::Vector2d>& points, const Color& fill, double opacity = 1.0);
  void disc(const Eigen::Vector2d& centre, double radius, const Color& fill);
  void ring(const Eigen::Vector2d& centre, double radius, const Color& color, double thickness = 1.5);
  void frame(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Color& color);
  /// `height` is that of a capital letter.
  void text(const Eigen::Vector2d& at, const std::string& words, double height, const Color& color,
            Align align = Align::kLeft, bool bold = false);
  void title(const std::string& title, const std::string& subtitle);

  /// Writes FILE.png and FILE.pdf, each whole or not at all, and returns their paths. Throws Error.
  std::vector<std::filesystem::path> save(const std::filesystem::path& file_without_extension) const;

 private:
  enum class Kind { kLine, kDashed, kPolyline, kPolygon, kDisc, kRing, kText };
  struct Shape {
    Kind kind = Kind::kLine;
    std::vector<Eigen::Vector2d> points;
    Color color;
    double size = 1.0;     ///< thickness, or the radius or height of the letters
    double opacity = 1.0;  ///< of a polygon; thickness of a ring
    std::string words;
    Align align = Align::kLeft;
    bool bold = false;
  };
  void draw(const Shape& shape, Canvas* canvas) const;
  std::string pdf() const;
  std::string operators(const Shape& shape) const;

  int width_, height_;
  std::vector<Shape> shapes_;
};

}  // namespace rigproof::inspect_detail
