// Drawing with smooth lines and legible text: everything is drawn three times too large and averaged.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace rigproof::inspect_detail {

struct Color {
  int r = 0, g = 0, b = 0;
  /// This color laid over white, 0 = white, 1 = itself.
  Color pale(double strength) const;
};

inline constexpr Color kInk{32, 36, 42};
inline constexpr Color kGrey{120, 126, 134};
inline constexpr Color kRule{222, 225, 229};
inline constexpr Color kPaper{255, 255, 255};
inline constexpr Color kAccent{200, 30, 30};

/// The same color for the same camera in every picture (Okabe and Ito's palette, told apart by the color-blind).
Color camera_color(std::size_t camera);
inline constexpr std::size_t kCameraColors = 8;  ///< then they come again

enum class Align { kLeft, kCentre, kRight };

/// Coordinates are pixels of the final picture, y down.
class Canvas {
 public:
  Canvas(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }

  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Color& color, double thickness = 1.0);
  void polyline(const std::vector<Eigen::Vector2d>& points, const Color& color, double thickness, bool closed);
  /// `opacity` below 1 lets what is underneath shine through.
  void polygon(const std::vector<Eigen::Vector2d>& points, const Color& fill, double opacity = 1.0);
  void disc(const Eigen::Vector2d& centre, double radius, const Color& fill);
  void ring(const Eigen::Vector2d& centre, double radius, const Color& color, double thickness = 1.0);
  void rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Color& fill);
  void frame(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Color& color, double thickness = 1.0);
  /// `at` is the left end, middle or right end of the baseline; `height` is that of a capital letter.
  void text(const Eigen::Vector2d& at, const std::string& text, double height, const Color& color,
            Align align = Align::kLeft, bool bold = false);
  static double text_width(const std::string& text, double height);
  /// As much of a text as is at most so wide, with dots where some is cut off.
  static std::string shortened(std::string text, double height, double width);
  /// A BGR image scaled into a rectangle.
  void image(const cv::Mat& bgr, const Eigen::Vector2d& corner, const Eigen::Vector2d& size);

  /// Averages and writes a PNG whole or not at all; returns its path. Throws Error.
  std::filesystem::path save(const std::filesystem::path& file) const;

 private:
  int width_, height_;
  cv::Mat pixels_;
};

/// Title in the top left corner with a lighter line below it; returns where the title ends.
double draw_title(Canvas* canvas, const std::string& title, const std::string& subtitle);
inline constexpr double kTitleHeight = 72.0;
inline constexpr double kMargin = 28.0;

/// Cameras' names in their colors, in a row that ends at the right margin; long ones are cut so that it begins behind
/// `left`.
void draw_camera_legend(Canvas* canvas, const std::vector<std::string>& names, double left, double baseline);

/// 1, 2 or 5 times a power of ten that is nearest below `value`.
double round_step(double value);

/// The least of 1, 1.5, 2, 3, 4, 5, 6, 8, 10 times a power of ten that is not below `value`: the end of an axis.
double round_up(double value);

/// A number as pictures show it: up to three significant digits and five decimals, no powers of ten.
std::string number(double value);

/// The image as BGR; empty where it cannot be read.
cv::Mat read_color(const std::filesystem::path& folder, const std::string& file);

}  // namespace rigproof::inspect_detail
