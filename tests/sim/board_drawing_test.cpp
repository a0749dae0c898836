// Boards as SVG and DXF, read by other code than that which wrote them: measured, and drawn for OpenCV's detectors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "printed_board.h"
#include "rigproof/sim/board_pattern.h"
#include "rigproof/sim/board_print.h"

namespace rigproof {
namespace {

constexpr double kPixelsPerMm = 8.0;
constexpr double kMargin_mm = 6.0, kBorder_mm = 10.0;

using Polygon = std::vector<cv::Point2d>;  // mm, y down from the upper left corner of the page

double area_of(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const cv::Point2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

std::vector<Board> boards() {
  return {board_of("checkerboard", 6, 5, 0.025), board_of("charuco", 7, 5, 0.04), board_of("aprilgrid", 5, 3, 0.04)};
}

// Where the first square of a fitting page begins, as the guide says.
cv::Point2d first_square(const Board& board, double page_width_mm) {
  const double overhang = board.type == "aprilgrid" ? 0.15 / 1.3 * 1000.0 * board.square_m : 0.0;
  const double width = 1000.0 * board.square_m * board.squares_x + 2.0 * (kBorder_mm + overhang);
  return {0.5 * (page_width_mm - width) + kBorder_mm + overhang, kMargin_mm + kBorder_mm + overhang};
}

// From there to corner 0 [m].
double to_first_corner_m(const Board& board) {
  return board.type == "aprilgrid" ? 0.15 / 1.3 * board.square_m : board.square_m;
}

// The dark areas as corners, sorted, to compare with [mm].
std::vector<std::array<double, 4>> sorted(std::vector<std::array<double, 4>> boxes) {
  std::sort(boxes.begin(), boxes.end());
  return boxes;
}

double dark_area_mm2(const Board& board) {
  double sum = 0.0;
  for (const DarkArea& area : dark_areas(board)) sum += 1e6 * (area.x1_m - area.x0_m) * (area.y1_m - area.y0_m);
  return sum;
}

cv::Mat drawn(const std::vector<Polygon>& polygons, cv::Size2d page_mm) {
  cv::Mat picture(cvRound(page_mm.height * kPixelsPerMm), cvRound(page_mm.width * kPixelsPerMm), CV_8UC1,
                  cv::Scalar(255));
  constexpr int kShift = 8;
  std::vector<std::vector<cv::Point>> contours;
  for (const Polygon& polygon : polygons) {
    contours.emplace_back();
    for (const cv::Point2d& point : polygon)
      contours.back().emplace_back(cvRound((point.x * kPixelsPerMm - 0.5) * (1 << kShift)),
                                   cvRound((point.y * kPixelsPerMm - 0.5) * (1 << kShift)));
  }
  cv::fillPoly(picture, contours, cv::Scalar(0), cv::LINE_AA, kShift);
  return picture;
}

// Every corner of an outline is a corner of a dark area, to a millionth of a millimetre.
void expect_corners_of(const Board& board, const std::vector<Polygon>& outlines, const cv::Point2d& first) {
  std::vector<double> xs, ys;
  for (const DarkArea& area : dark_areas(board)) {
    for (const double x_m : {area.x0_m, area.x1_m}) xs.push_back(first.x + 1000.0 * (x_m + to_first_corner_m(board)));
    for (const double y_m : {area.y0_m, area.y1_m}) ys.push_back(first.y + 1000.0 * (y_m + to_first_corner_m(board)));
  }
  const auto near = [](const std::vector<double>& values, double value) {
    return std::any_of(values.begin(), values.end(), [value](double v) { return std::abs(v - value) < 1e-6; });
  };
  for (const Polygon& outline : outlines)
    for (const cv::Point2d& point : outline)
      ASSERT_TRUE(near(xs, point.x) && near(ys, point.y)) << board.type << " " << point;
}

struct Drawing {
  cv::Size2d page_mm;
  std::vector<Polygon> outlines;
};

Drawing read_svg(const std::string& svg) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(svg.c_str()));
  const pugi::xml_node root = document.child("svg");
  Drawing drawing{{root.attribute("width").as_double(), root.attribute("height").as_double()}, {}};
  EXPECT_STREQ(root.attribute("width").value() + std::string(root.attribute("width").value()).size() - 2, "mm");
  std::istringstream box(root.attribute("viewBox").value());
  double x = 1.0, y = 1.0, width = 0.0, height = 0.0;
  box >> x >> y >> width >> height;
  EXPECT_EQ(std::vector<double>({x, y, width, height}),
            std::vector<double>({0.0, 0.0, drawing.page_mm.width, drawing.page_mm.height}));
  const pugi::xml_node path = root.find_child_by_attribute("path", "id", "dark");
  EXPECT_STREQ(path.attribute("fill").value(), "#000");
  EXPECT_STREQ(path.attribute("fill-rule").value(), "evenodd");
  std::istringstream commands(path.attribute("d").value());
  for (char command = 0; commands >> command;) {
    if (command == 'Z') continue;
    if (command == 'M') drawing.outlines.emplace_back();
    cv::Point2d point;
    EXPECT_TRUE(commands >> point.x >> point.y);
    drawing.outlines.back().push_back(point);
  }
  return drawing;
}

TEST(BoardSvg, HasTheBoardAtItsTrueSize) {
  for (const Board& board : boards()) {
    const Drawing drawing = read_svg(board_svg(board, {}));
    expect_corners_of(board, drawing.outlines, first_square(board, drawing.page_mm.width));
    // y is down: outlines run clockwise as seen, holes the other way.
    double area = 0.0;
    for (const Polygon& outline : drawing.outlines) area -= area_of(outline);
    EXPECT_NEAR(area, dark_area_mm2(board), 1e-6 * dark_area_mm2(board)) << board.type;
    expect_board(board, drawn(drawing.outlines, drawing.page_mm), kPixelsPerMm, 0.2);
  }
}

TEST(BoardSvg, SquaresOfACheckerboardAreOutlinesOfTheirOwn) {
  const Drawing drawing = read_svg(board_svg(board_of("checkerboard", 6, 5, 0.025), {}));
  EXPECT_EQ(drawing.outlines.size(), 15U);
  for (const Polygon& outline : drawing.outlines) EXPECT_EQ(outline.size(), 4U);
  EXPECT_NEAR(drawing.outlines.front()[0].x - drawing.outlines.front()[1].x, -25.0, 1e-6);
}

TEST(BoardSvg, RulersAreThere) {
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(board_svg(board_of("checkerboard", 6, 5, 0.025), {"a4", 0.01}).c_str()));
  double across = 0.0, upright = 0.0;
  for (const pugi::xml_node line : document.child("svg").find_child_by_attribute("g", "id", "rulers").children()) {
    const auto number = [&](const char* name) { return line.attribute(name).as_double(); };
    across = std::max(across, std::abs(number("x2") - number("x1")));
    upright = std::max(upright, std::abs(number("y2") - number("y1")));
  }
  EXPECT_NEAR(across, 150.0, 1e-6);
  EXPECT_NEAR(upright, 200.0, 1e-6);
}

// One entity: group codes in order, with points by their number.
struct Entity {
  std::string type, layer;
  std::map<int, std::string> values;
  Polygon points;  // 10 to 13, or vertices; y up
};
struct Dxf {
  std::map<std::string, std::string> header, layer_colours;
  std::vector<Entity> entities;
};

std::vector<std::pair<int, std::string>> pairs_of(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::pair<int, std::string>> pairs;
  for (std::string code, value; std::getline(lines, code) && std::getline(lines, value);)
    pairs.emplace_back(std::stoi(code), value);
  return pairs;
}

Dxf read_dxf(const std::string& text) {
  Dxf dxf;
  std::string section, variable;
  std::vector<Entity> all;
  const auto pairs = pairs_of(text);
  EXPECT_EQ(pairs.back(), (std::pair<int, std::string>(0, "EOF")));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto& [code, value] = pairs[i];
    if (code == 2 && i > 0 && pairs[i - 1].second == "SECTION") section = value;
    if (section == "HEADER" && code == 9) variable = value;
    if (section == "HEADER" && code != 9) dxf.header.emplace(variable, value);
    if (code == 0) all.push_back({value, "", {}, {}});
    if (all.empty()) continue;
    Entity& entity = all.back();
    if (code == 8) entity.layer = value;
    entity.values.emplace(code, value);
    if (code >= 10 && code <= 13) entity.points.emplace_back(std::stod(value), 0.0);
    if (code >= 20 && code <= 23) entity.points.back().y = std::stod(value);
  }
  for (const Entity& entity : all) {
    if (entity.type == "LAYER") dxf.layer_colours[entity.values.at(2)] = entity.values.at(62);
    if (entity.type == "VERTEX") {
      dxf.entities.back().points.push_back(entity.points.at(0));
      EXPECT_EQ(entity.layer, dxf.entities.back().layer);
    } else if (!entity.layer.empty() && entity.type != "SEQEND") {
      dxf.entities.push_back(entity);
      if (entity.type == "POLYLINE") dxf.entities.back().points.clear();
    }
  }
  return dxf;
}

std::vector<Polygon> polygons(const Dxf& dxf, const std::string& type, const std::string& layer, double height_mm) {
  std::vector<Polygon> result;
  for (const Entity& entity : dxf.entities) {
    if (entity.type != type || entity.layer != layer) continue;
    Polygon polygon = entity.points;
    for (cv::Point2d& point : polygon) point.y = height_mm - point.y;
    if (type == "SOLID") std::swap(polygon.at(2), polygon.at(3));  // DXF: row by row, not around
    result.push_back(polygon);
  }
  return result;
}

TEST(BoardDxf, HasTheBoardAtItsTrueSizeFilledAndAsOutlines) {
  for (const Board& board : boards()) {
    const Dxf dxf = read_dxf(board_dxf(board, {}));
    EXPECT_EQ(dxf.header.at("$ACADVER"), "AC1009");
    EXPECT_EQ(dxf.header.at("$INSUNITS"), "4") << "millimetres";
    const double width = std::stod(dxf.header.at("$EXTMAX"));
    const auto sheet = polygons(dxf, "POLYLINE", "SHEET", 0.0);
    ASSERT_EQ(sheet.size(), 1U);
    const double height =
        -std::min_element(sheet[0].begin(), sheet[0].end(), [](auto a, auto b) { return a.y < b.y; })->y;
    EXPECT_NEAR(std::abs(area_of(sheet[0])), width * height, 1e-6);
    const cv::Point2d first = first_square(board, width);

    const std::vector<Polygon> solids = polygons(dxf, "SOLID", "DARK", height);
    std::vector<std::array<double, 4>> found, expected;
    for (const Polygon& solid : solids) {
      ASSERT_EQ(solid.size(), 4U);
      const cv::Point2d low = solid[3], high = solid[1];
      EXPECT_NEAR(std::abs(area_of(solid)), (high.x - low.x) * (low.y - high.y) * -1.0, 1e-6) << "no bow tie";
      found.push_back({low.x, low.y, high.x, high.y});
    }
    for (const DarkArea& area : dark_areas(board)) {
      const auto mm = [&](double m, double from) { return from + 1000.0 * (m + to_first_corner_m(board)); };
      expected.push_back(
          {mm(area.x0_m, first.x), mm(area.y0_m, first.y), mm(area.x1_m, first.x), mm(area.y1_m, first.y)});
    }
    ASSERT_EQ(found.size(), expected.size());
    found = sorted(found);
    expected = sorted(expected);
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[i][k], expected[i][k], 1e-6) << board.type << " " << i;

    const std::vector<Polygon> outlines = polygons(dxf, "POLYLINE", "OUTLINES", height);
    expect_corners_of(board, outlines, first);
    double area = 0.0;
    for (const Polygon& outline : outlines) area -= area_of(outline);
    EXPECT_NEAR(area, dark_area_mm2(board), 1e-6 * dark_area_mm2(board)) << board.type;
    expect_board(board, drawn(outlines, {width, height}), kPixelsPerMm, 0.2);
    for (const Entity& entity : dxf.entities)
      if (entity.type == "POLYLINE") {
        EXPECT_EQ(entity.values.at(70), "1") << "closed";
      }
  }
}

TEST(BoardDxf, LayersKeepWhatIsFilledApartFromWhatIsCut) {
  const Dxf dxf = read_dxf(board_dxf(board_of("checkerboard", 6, 5, 0.025), {}));
  EXPECT_EQ(dxf.layer_colours.at("DARK"), "7");
  EXPECT_EQ(dxf.layer_colours.at("OUTLINES"), "-7") << "off";
  for (const Entity& entity : dxf.entities) EXPECT_EQ(dxf.layer_colours.count(entity.layer), 1U) << entity.layer;
  double across = 0.0, upright = 0.0;
  for (const Entity& entity : dxf.entities) {
    if (entity.type != "LINE") continue;
    across = std::max(across, std::abs(entity.points.at(1).x - entity.points.at(0).x));
    upright = std::max(upright, std::abs(entity.points.at(1).y - entity.points.at(0).y));
  }
  EXPECT_NEAR(across, 150.0, 1e-6);
  EXPECT_NEAR(upright, 150.0, 1e-6);
}

}  // namespace
}  // namespace rigproof
