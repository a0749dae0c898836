#include "inspect_canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/png/png_reader.h"

namespace rigproof::inspect_detail {
namespace {

constexpr int kScale = 3;          // supersampling
constexpr int kShift = 4;          // OpenCV draws at 1/16 of its pixels
constexpr double kCapital = 21.0;  // height of a capital of OpenCV's simplex font at scale 1

cv::Scalar bgr(const Color& color) { return cv::Scalar(color.b, color.g, color.r); }

// The centre of a final pixel is the centre of its kScale x kScale block.
cv::Point fixed(const Eigen::Vector2d& p) {
  const double offset = 0.5 * (kScale - 1), unit = 1 << kShift;
  return {static_cast<int>(std::lround((kScale * p.x() + offset) * unit)),
          static_cast<int>(std::lround((kScale * p.y() + offset) * unit))};
}

int thick(double thickness) { return std::max(1, static_cast<int>(std::lround(kScale * thickness))); }

double font_scale(double height) { return kScale * height / kCapital; }

int font_thickness(double height, bool bold) {
  return std::max(1, static_cast<int>(std::lround(kScale * height * (bold ? 0.19 : 0.115))));
}

std::vector<cv::Point> fixed(const std::vector<Eigen::Vector2d>& points) {
  std::vector<cv::Point> result;
  for (const Eigen::Vector2d& p : points) result.push_back(fixed(p));
  return result;
}

}  // namespace

Color Color::pale(double strength) const {
  const auto mix = [strength](int value) { return static_cast<int>(std::lround(255.0 + strength * (value - 255.0))); };
  return {mix(r), mix(g), mix(b)};
}

Color camera_color(std::size_t camera) {
  static constexpr std::array<Color, kCameraColors> kColors = {{{0, 114, 178},
                                                                {213, 94, 0},
                                                                {0, 158, 115},
                                                                {204, 121, 167},
                                                                {86, 180, 233},
                                                                {230, 159, 0},
                                                                {138, 106, 63},
                                                                {112, 112, 216}}};
  return kColors[camera % kColors.size()];
}

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), pixels_(kScale * height, kScale * width, CV_8UC3, bgr(kPaper)) {}

void Canvas::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Color& color, double thickness) {
  cv::line(pixels_, fixed(from), fixed(to), bgr(color), thick(thickness), cv::LINE_AA, kShift);
}

void Canvas::polyline(const std::vector<Eigen::Vector2d>& points, const Color& color, double thickness, bool closed) {
  cv::polylines(pixels_, fixed(points), closed, bgr(color), thick(thickness), cv::LINE_AA, kShift);
}

void Canvas::polygon(const std::vector<Eigen::Vector2d>& points, const Color& fill, double opacity) {
  std::vector<std::vector<cv::Point>> polygons = {fixed(points)};
  if (opacity >= 1.0) return cv::fillPoly(pixels_, polygons, bgr(fill), cv::LINE_AA, kShift);
  cv::Rect area = cv::boundingRect(polygons[0]);
  area = cv::Rect(area.x >> kShift, area.y >> kShift, (area.width >> kShift) + 2, (area.height >> kShift) + 2);
  area &= cv::Rect(0, 0, pixels_.cols, pixels_.rows);
  if (area.empty()) return;
  cv::Mat below = pixels_(area), above = below.clone();
  const cv::Point origin(-area.x * (1 << kShift), -area.y * (1 << kShift));
  for (cv::Point& p : polygons[0]) p += origin;
  cv::fillPoly(above, polygons, bgr(fill), cv::LINE_AA, kShift);
  cv::addWeighted(above, opacity, below, 1.0 - opacity, 0.0, below);
}

void Canvas::disc(const Eigen::Vector2d& centre, double radius, const Color& fill) {
  const int r = static_cast<int>(std::lround(kScale * radius * (1 << kShift)));
  cv::circle(pixels_, fixed(centre), r, bgr(fill), cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::ring(const Eigen::Vector2d& centre, double radius, const Color& color, double thickness) {
  const int r = static_cast<int>(std::lround(kScale * radius * (1 << kShift)));
  cv::circle(pixels_, fixed(centre), r, bgr(color), thick(thickness), cv::LINE_AA, kShift);
}

void Canvas::rectangle(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Color& fill) {
  polygon({corner, corner + Eigen::Vector2d(size.x(), 0.0), corner + size, corner + Eigen::Vector2d(0.0, size.y())},
          fill);
}

void Canvas::frame(const Eigen::Vector2d& corner, const Eigen::Vector2d& size, const Color& color, double thickness) {
  polyline({corner, corner + Eigen::Vector2d(size.x(), 0.0), corner + size, corner + Eigen::Vector2d(0.0, size.y())},
           color, thickness, true);
}

double Canvas::text_width(const std::string& text, double height) {
  int baseline = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, font_scale(height), 1, &baseline).width /
         static_cast<double>(kScale);
}

std::string Canvas::shortened(std::string text, double height, double width) {
  if (text_width(text, height) <= width) return text;
  while (!text.empty() && text_width(text + "...", height) > width) text.pop_back();
  return text + "...";
}

void Canvas::text(const Eigen::Vector2d& at, const std::string& text, double height, const Color& color, Align align,
                  bool bold) {
  const double width = text_width(text, height);
  const double left = align == Align::kLeft ? 0.0 : align == Align::kCentre ? 0.5 * width : width;
  const cv::Point origin(static_cast<int>(std::lround(kScale * (at.x() - left))),
                         static_cast<int>(std::lround(kScale * at.y())));
  cv::putText(pixels_, text, origin, cv::FONT_HERSHEY_SIMPLEX, font_scale(height), bgr(color),
              font_thickness(height, bold), cv::LINE_AA);
}

void Canvas::image(const cv::Mat& picture, const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
  const cv::Rect target(
      static_cast<int>(std::lround(kScale * corner.x())), static_cast<int>(std::lround(kScale * corner.y())),
      static_cast<int>(std::lround(kScale * size.x())), static_cast<int>(std::lround(kScale * size.y())));
  const cv::Rect inside = target & cv::Rect(0, 0, pixels_.cols, pixels_.rows);
  if (picture.empty() || inside != target || target.empty()) return;
  const bool shrinks = target.width < picture.cols;
  cv::resize(picture, pixels_(target), target.size(), 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
}

std::filesystem::path Canvas::save(const std::filesystem::path& file) const {
  cv::Mat averaged;
  cv::resize(pixels_, averaged, cv::Size(width_, height_), 0.0, 0.0, cv::INTER_AREA);
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(".png", averaged, bytes, {cv::IMWRITE_PNG_COMPRESSION, 3}))
    throw Error(file.string() + ": the picture could not be encoded as PNG");
  write_file_atomically(file, bytes);
  return file;
}

double draw_title(Canvas* canvas, const std::string& title, const std::string& subtitle) {
  constexpr double kHeight = 13.0;
  canvas->text({kMargin, 32.0}, title, kHeight, kInk, Align::kLeft, true);
  canvas->text({kMargin, 54.0}, subtitle, 9.5, kGrey);
  return kMargin + Canvas::text_width(title, kHeight);
}

void draw_camera_legend(Canvas* canvas, const std::vector<std::string>& names, double left, double baseline) {
  constexpr double kHeight = 9.5, kBetween = 34.0;
  double x = canvas->width() - kMargin;
  for (std::size_t i = names.size(); i-- > 0;) {
    // What short names leave, those before them may have.
    const double room = (x - left) / static_cast<double>(i + 1) - kBetween;
    const std::string name = Canvas::shortened(names[i], kHeight, room);
    x -= Canvas::text_width(name, kHeight);
    canvas->text({x, baseline}, name, kHeight, kInk);
    canvas->disc({x - 12.0, baseline - 0.5 * kHeight}, 5.0, camera_color(i));
    x -= kBetween;
  }
}

double round_step(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double leading = value / power;
  return power * (leading >= 5.0 ? 5.0 : leading >= 2.0 ? 2.0 : 1.0);
}

double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double leading : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (value <= leading * power * (1.0 + 1e-9)) return leading * power;
  return 10.0 * power;
}

std::string number(double value) {
  constexpr int kDigits = 3, kMaxDecimals = 5;
  const double magnitude = std::abs(value);
  if (!(magnitude > 0.0) || !std::isfinite(magnitude)) return magnitude > 0.0 ? "inf" : "0";
  const int decimals = std::clamp(kDigits - 1 - static_cast<int>(std::floor(std::log10(magnitude))), 0, kMaxDecimals);
  std::string text = fixed_text(value, decimals);
  if (decimals > 0) text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

namespace {

// What recorders and the generator write, several times faster than OpenCV, which would also print what is wrong with a
// broken one: empty then. Absent for any other file.
std::optional<cv::Mat> read_rgb_png(const std::vector<std::uint8_t>& bytes) {
  const std::optional<PngHeader> header = is_png(bytes) ? read_png_header(bytes) : std::nullopt;
  constexpr std::uint32_t kLargestSide = 16384;
  if (!header || !header->is_plain() || header->bit_depth != 8 || header->color_type != 2) return std::nullopt;
  if (std::max(header->width, header->height) > kLargestSide) return cv::Mat();
  auto decoded = decode_png_rgb(bytes, *header);
  Image8* image = std::get_if<Image8>(&decoded);
  if (image == nullptr) return cv::Mat();
  cv::Mat bgr;
  cv::cvtColor(cv::Mat(image->height, image->width, CV_8UC3, image->pixels.data()), bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

}  // namespace

cv::Mat read_color(const std::filesystem::path& folder, const std::string& file) {
  try {
    const std::vector<std::uint8_t> bytes = read_binary_file(path_inside(folder, file));
    if (const std::optional<cv::Mat> picture = read_rgb_png(bytes)) return *picture;
    return bytes.empty() ? cv::Mat() : cv::imdecode(bytes, cv::IMREAD_COLOR);
  } catch (const Error&) {
    return {};
  } catch (const cv::Exception&) {
    return {};
  }
}

}  // namespace rigproof::inspect_detail
