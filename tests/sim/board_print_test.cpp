// Boards as PDF, read back by rendering it: one page, and tiles put together by their crosses.
#include "rigproof/sim/board_print.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "board_tiles.h"
#include "error_text.h"
#include "printed_board.h"
#include "process.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Dark and light runs along a line of pixels, in pixels: edges are where the level crosses the middle. The upright
// ruler at the left of the page is no part of it.
std::vector<double> edges_of(const cv::Mat& line, int first = 0) {
  std::vector<double> edges;
  const auto level = [&](int i) { return static_cast<double>(line.at<std::uint8_t>(i)); };
  for (int i = first + 1; i < static_cast<int>(line.total()); ++i) {
    const double a = level(i - 1), b = level(i);
    if ((a < 128.0) != (b < 128.0)) edges.push_back(i - 1 + (128.0 - a) / (b - a));
  }
  return edges;
}

class PrintedPages : public testing::Test {
 protected:
  std::vector<cv::Mat> render_pages(const std::string& pdf, int dots_per_inch) {
    std::ofstream(folder_ / "board.pdf", std::ios::binary) << pdf;
    const ProcessOutput result = run_process({"pdftoppm", "-r", std::to_string(dots_per_inch), "-gray",
                                              (folder_ / "board.pdf").string(), (folder_ / "page").string()});
    EXPECT_EQ(result.exit_code, 0) << "pdftoppm is in the package poppler-utils\n" << result.err;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.path().extension() == ".pgm") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<cv::Mat> pages;
    for (const auto& file : files) {
      pages.push_back(cv::imread(file.string(), cv::IMREAD_GRAYSCALE));
      std::filesystem::remove(file);
    }
    return pages;
  }

  const TempFolder folder_;
};

// The longest line of dark pixels along the rows [px].
int longest_run(const cv::Mat& part) {
  int longest = 0;
  for (int y = 0; y < part.rows; ++y) {
    int run = 0;
    for (int x = 0; x < part.cols; ++x)
      longest = std::max(longest, run = part.at<std::uint8_t>(y, x) < 200 ? run + 1 : 0);
  }
  return longest;
}

class BoardPdfTest : public PrintedPages {
 protected:
  static constexpr int kDotsPerInch = 300;
  static constexpr double kPixelsPerMm = kDotsPerInch / 25.4;
  static constexpr int kBesideRuler = static_cast<int>(13.0 * kPixelsPerMm);

  cv::Mat render(const std::string& pdf) {
    const std::vector<cv::Mat> pages = render_pages(pdf, kDotsPerInch);
    EXPECT_EQ(pages.size(), 1U);
    return pages.at(0);
  }

  // Its base line is the longest dark run below the board, which ends there.
  static double ruler_across_mm(const cv::Mat& page, double board_end_mm) {
    return longest_run(page.rowRange(static_cast<int>(board_end_mm * kPixelsPerMm), page.rows)) / kPixelsPerMm;
  }
  static double upright_ruler_mm(const cv::Mat& page) {
    return longest_run(page.colRange(0, kBesideRuler).t()) / kPixelsPerMm;
  }
};
TEST_F(BoardPdfTest, SquaresAndRulersHaveTheirTrueSize) {
  const cv::Mat page = render(board_pdf(board_of("checkerboard", 6, 5, 0.025), {"a4", 0.01}));
  ASSERT_FALSE(page.empty());
  // A4 upright holds 150 mm of squares.
  EXPECT_NEAR(page.cols, 210.0 * kPixelsPerMm, 1.0);
  EXPECT_NEAR(page.rows, 297.0 * kPixelsPerMm, 1.0);
  // The first row of squares, 6 + 10 mm below the edge of the page: dark, light, dark, light, dark and a last light
  // one.
  const int row = static_cast<int>((16.0 + 12.5) * kPixelsPerMm);
  const std::vector<double> edges = edges_of(page.row(row), kBesideRuler);
  ASSERT_EQ(edges.size(), 6U);
  // The renderer rounds edges to whole pixels of 0.085 mm.
  for (std::size_t i = 1; i < edges.size(); ++i) EXPECT_NEAR((edges[i] - edges[i - 1]) / kPixelsPerMm, 25.0, 0.1);
  EXPECT_NEAR(edges.front() / kPixelsPerMm, 0.5 * (210.0 - 150.0), 0.1) << "in the middle of the page";
  const std::vector<double> down = edges_of(page.col(static_cast<int>(42.5 * kPixelsPerMm)));
  ASSERT_GE(down.size(), 6U);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_NEAR((down[i] - down[i - 1]) / kPixelsPerMm, 25.0, 0.1);
  EXPECT_NEAR(down.front() / kPixelsPerMm, 16.0, 0.1);
  EXPECT_NEAR(ruler_across_mm(page, 155.0), 150.0, 0.4) << "an A4 page has room for 150 mm";
  EXPECT_NEAR(upright_ruler_mm(page), 200.0, 0.4);
}

TEST_F(BoardPdfTest, MarkerBoardsAreFoundInTheirTrueSize) {
  for (const Board& board : {board_of("charuco", 7, 5, 0.04), board_of("aprilgrid", 5, 3, 0.04)}) {
    const cv::Mat page = render(board_pdf(board, {"fit", 0.01}));
    // Corners of contours are whole pixels of 0.085 mm inside of the tag, two to three in all.
    expect_board(board, page, kPixelsPerMm, 0.3);
    const double end_mm = 16.0 + 40.0 * board.squares_y + 2.0 * 4.7;
    EXPECT_NEAR(ruler_across_mm(page, end_mm), 200.0, 0.4) << board.type;
    EXPECT_GE(upright_ruler_mm(page), 149.6) << board.type;
  }
}

TEST_F(BoardPdfTest, ABoardThatFitsOnlyOnItsSideIsTurned) {
  // 6 x 5 squares of 35 mm, 210 x 175 mm: with the lines below too high for A4 across, too wide for it upright.
  const cv::Mat page = render(board_pdf(board_of("checkerboard", 6, 5, 0.035), {"a4", 0.005}));
  ASSERT_FALSE(page.empty());
  EXPECT_NEAR(page.cols, 210.0 * kPixelsPerMm, 1.0);
  // The first row of squares runs down the right: five along the page's width, six along its height.
  const std::vector<double> across = edges_of(page.row(static_cast<int>((11.0 + 17.5) * kPixelsPerMm)), kBesideRuler);
  ASSERT_GE(across.size(), 5U);
  EXPECT_NEAR(across.back() / kPixelsPerMm, 0.5 * (210.0 + 175.0), 0.2) << "dark at the top right";
  const std::vector<double> down = edges_of(page.col(static_cast<int>((0.5 * (210.0 + 175.0) - 17.5) * kPixelsPerMm)));
  ASSERT_GE(down.size(), 6U);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_NEAR((down[i] - down[i - 1]) / kPixelsPerMm, 35.0, 0.2);
}

TEST(BoardPdf, SaysWhatWouldFit) {
  EXPECT_THAT(error_text([] {
                board_pdf(board_of("checkerboard", 6, 5, 0.11), {"a4", 0.01});
              }),
              AllOf(HasSubstr("a4"), HasSubstr("110 mm do not fit"), HasSubstr("squares of up to 35 mm")));
  EXPECT_THAT(error_text([] { board_pdf(Board(), {"a7", 0.01}); }), HasSubstr("a4, a3"));
}

TEST(BoardPdf, IsTheSameAgainAndHasTheInstructions) {
  const std::string pdf = board_pdf(Board(), {});
  EXPECT_EQ(pdf, board_pdf(Board(), {}));
  EXPECT_THAT(pdf, AllOf(HasSubstr("Print at 100 %"), HasSubstr("divided by 5 as square_mm"),
                         HasSubstr("/PrintScaling /None")));
}

// The crosses of a tile [px], found by their size and thinness alone.
struct Crosses {
  double left, right, top, bottom;  // the cuts that they mark
};
constexpr int kTileDotsPerInch = 200;
constexpr double kTilePixelsPerMm = kTileDotsPerInch / 25.4;

Crosses crosses_of(const cv::Mat& page) {
  cv::Mat labels, boxes, centres;
  const cv::Mat ink = page < 200;
  const int count = cv::connectedComponentsWithStats(ink, labels, boxes, centres);
  std::vector<cv::Point2d> crosses;
  for (int i = 1; i < count; ++i) {
    const double width = boxes.at<int>(i, cv::CC_STAT_WIDTH) / kTilePixelsPerMm;
    const double height = boxes.at<int>(i, cv::CC_STAT_HEIGHT) / kTilePixelsPerMm;
    const double area = boxes.at<int>(i, cv::CC_STAT_AREA) / (kTilePixelsPerMm * kTilePixelsPerMm);
    if (std::abs(width - 5.0) < 0.4 && std::abs(height - 5.0) < 0.4 && area < 5.0)
      crosses.emplace_back(centres.at<double>(i, 0), centres.at<double>(i, 1));
  }
  EXPECT_EQ(crosses.size(), 8U);
  if (crosses.size() != 8U) return {};
  // Two above and two below the piece have its cuts' x; two at either side of it their y.
  std::sort(crosses.begin(), crosses.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  const std::array<cv::Point2d, 2> at_left = {crosses[0], crosses[1]}, at_right = {crosses[6], crosses[7]};
  const double left = 0.5 * (crosses[2].x + crosses[3].x), right = 0.5 * (crosses[4].x + crosses[5].x);
  EXPECT_NEAR(crosses[2].x, crosses[3].x, 1.0);
  EXPECT_NEAR(crosses[4].x, crosses[5].x, 1.0);
  const auto upper = [](const std::array<cv::Point2d, 2>& two) { return std::min(two[0].y, two[1].y); };
  const auto lower = [](const std::array<cv::Point2d, 2>& two) { return std::max(two[0].y, two[1].y); };
  EXPECT_NEAR(upper(at_left), upper(at_right), 1.0);
  EXPECT_NEAR(lower(at_left), lower(at_right), 1.0);
  return {left, right, 0.5 * (upper(at_left) + upper(at_right)), 0.5 * (lower(at_left) + lower(at_right))};
}

cv::Mat piece_of(const cv::Mat& page, const Crosses& cut) {
  const cv::Rect inside(cvRound(cut.left), cvRound(cut.top), cvRound(cut.right - cut.left),
                        cvRound(cut.bottom - cut.top));
  return page(inside);
}

// What a person does: each page cut at its crosses, and one laid beside the other.
cv::Mat put_together(const std::vector<cv::Mat>& tiles, const TileGrid& grid) {
  std::vector<cv::Mat> rows;
  for (int row = 0; row < grid.rows; ++row) {
    std::vector<cv::Mat> pieces;
    for (int column = 0; column < grid.columns; ++column) {
      const cv::Mat& page = tiles[static_cast<std::size_t>(row * grid.columns + column)];
      pieces.push_back(piece_of(page, crosses_of(page)));
    }
    for (cv::Mat& piece : pieces) {
      EXPECT_NEAR(piece.rows, pieces.front().rows, 1.0);
      piece = piece.rowRange(0, std::min(piece.rows, pieces.front().rows)).clone();
      cv::copyMakeBorder(piece, piece, 0, pieces.front().rows - piece.rows, 0, 0, cv::BORDER_REPLICATE);
    }
    rows.emplace_back();
    cv::hconcat(pieces, rows.back());
  }
  for (cv::Mat& row : rows) {
    EXPECT_NEAR(row.cols, rows.front().cols, grid.columns);
    row = row.colRange(0, std::min(row.cols, rows.front().cols)).clone();
    cv::copyMakeBorder(row, row, 0, 0, 0, rows.front().cols - row.cols, cv::BORDER_REPLICATE);
  }
  cv::Mat whole;
  cv::vconcat(rows, whole);
  return whole;
}

struct TiledCase {
  Board board;
  const char* paper;
  int rows, columns;
  bool across;
};

// Portrait: a page holds 179.5 x 256 mm of the board, across 266.5 x 169 mm.
class Tiles : public PrintedPages {
 protected:
  static std::vector<TiledCase> cases() {
    return {{board_of("checkerboard", 6, 5, 0.06), "a4", 2, 2, true},
            {board_of("charuco", 5, 7, 0.06), "a4", 2, 2, false},
            {board_of("aprilgrid", 4, 3, 0.08), "a4", 2, 2, true},
            {board_of("checkerboard", 5, 4, 0.12), "letter", 3, 3, true}};
  }
};

TEST_F(Tiles, PutTogetherByTheirCrossesTheyAreTheBoard) {
  for (const TiledCase& tried : cases()) {
    BoardPrint print{tried.paper, 0.01};
    print.tiles = true;
    const std::string pdf = board_pdf(tried.board, print);
    const TileGrid grid = tile_grid(tried.board, print);
    EXPECT_EQ(grid.rows, tried.rows) << tried.board.type;
    EXPECT_EQ(grid.columns, tried.columns) << tried.board.type;
    std::vector<cv::Mat> pages = render_pages(pdf, kTileDotsPerInch);
    ASSERT_EQ(static_cast<int>(pages.size()), 1 + grid.count()) << tried.board.type;
    for (const cv::Mat& page : pages) EXPECT_EQ(page.cols > page.rows, tried.across) << tried.board.type;
    pages.erase(pages.begin());
    const cv::Mat whole = put_together(pages, grid);
    // Each edge is rounded to a pixel of 0.13 mm, and so are the crosses of each piece.
    expect_board(tried.board, whole, kTilePixelsPerMm, 0.3);
    const double overhang_mm = tried.board.type == "aprilgrid" ? 0.15 / 1.3 * 80.0 : 0.0;
    EXPECT_NEAR(whole.cols / kTilePixelsPerMm,
                1000.0 * tried.board.square_m * tried.board.squares_x + 20.0 + 2.0 * overhang_mm, 0.3);
    EXPECT_NEAR(whole.rows / kTilePixelsPerMm,
                1000.0 * tried.board.square_m * tried.board.squares_y + 20.0 + 2.0 * overhang_mm, 0.3);
  }
}

TEST_F(Tiles, EachPageHasBothRulersItsPlaceAndAWhiteEdge) {
  BoardPrint print{"a4", 0.01};
  print.tiles = true;
  print.printer_margin_m = 0.012;
  const Board board = board_of("checkerboard", 6, 5, 0.07);
  const std::string pdf = board_pdf(board, print);
  const TileGrid grid = tile_grid(board, print);
  ASSERT_GT(grid.rows * grid.columns, 4);
  std::size_t at = 0;
  for (int row = 1; row <= grid.rows; ++row)
    for (int column = 1; column <= grid.columns; ++column) {
      const std::string place = "row " + std::to_string(row) + ", column " + std::to_string(column) + " of " +
                                std::to_string(grid.rows) + " x " + std::to_string(grid.columns) + "   \\(page " +
                                std::to_string(1 + (row - 1) * grid.columns + column) + " of " +
                                std::to_string(grid.count() + 1);
      const std::size_t found = pdf.find(place, at);
      ASSERT_NE(found, std::string::npos) << place << ", in the order of the rows";
      at = found;
    }
  for (const cv::Mat& page : render_pages(pdf, kTileDotsPerInch)) {
    const int margin = static_cast<int>(12.0 * kTilePixelsPerMm), strip = static_cast<int>(6.5 * kTilePixelsPerMm);
    const cv::Rect inside(margin, margin, page.cols - 2 * margin, page.rows - 2 * margin);
    cv::Mat edge = page.clone();
    edge(inside).setTo(255);
    EXPECT_EQ(cv::countNonZero(edge < 250), 0) << "printers leave the edge blank";
    const int footer = static_cast<int>(17.0 * kTilePixelsPerMm);
    const double across = longest_run(page.rowRange(page.rows - margin - footer, page.rows)) / kTilePixelsPerMm;
    const double upright = longest_run(page.colRange(0, margin + strip).t()) / kTilePixelsPerMm;
    EXPECT_NEAR(across, page.cols > page.rows ? 200.0 : 150.0, 0.4);
    EXPECT_NEAR(upright, page.cols > page.rows ? 150.0 : 200.0, 0.4);
  }
}

TEST_F(Tiles, WhatLiesBelowTheNextPageIsPrintedOnBoth) {
  BoardPrint print{"a4", 0.01};
  print.tiles = true;
  print.overlap_m = 0.02;
  const Board board = board_of("charuco", 9, 3, 0.049);
  ASSERT_EQ(tile_grid(board, print).columns, 2);
  ASSERT_EQ(tile_grid(board, print).rows, 1);
  const std::vector<cv::Mat> pages = render_pages(board_pdf(board, print), kTileDotsPerInch);
  ASSERT_EQ(pages.size(), 3U);
  const Crosses one = crosses_of(pages[1]), two = crosses_of(pages[2]);
  const int width = static_cast<int>(19.8 * kTilePixelsPerMm), height = cvRound(one.bottom - one.top);
  const cv::Mat under = pages[1](cv::Rect(cvRound(one.right), cvRound(one.top), width, height));
  const cv::Mat over = pages[2](cv::Rect(cvRound(two.left), cvRound(two.top), width, height));
  EXPECT_GT(cv::countNonZero(under < 128), 0.2 * static_cast<double>(under.total()));
  cv::Mat difference;
  cv::absdiff(under, over, difference);
  cv::erode(difference, difference, cv::Mat(), {-1, -1}, 2);  // edges may be a pixel apart
  EXPECT_EQ(cv::countNonZero(difference > 100), 0);
}

TEST(TilesOfABoard, ThatFitsOnePageAreThatPage) {
  BoardPrint print{"a4", 0.01};
  const std::string page = board_pdf(Board(), {"a1", 0.01});
  print.paper = "a1";
  print.tiles = true;
  EXPECT_EQ(board_pdf(Board(), print), page);
  EXPECT_EQ(tile_grid(Board(), print).count(), 1);
}

TEST(TilesOfABoard, ThatCannotBeAreRefused) {
  const auto error = [](double square_m, BoardPrint print) {
    print.tiles = true;
    return error_text([&] { board_pdf(board_of("checkerboard", 6, 5, square_m), print); });
  };
  EXPECT_THAT(error(0.9, {"a4", 0.01}), AllOf(HasSubstr("5420 x 4520 mm"), HasSubstr("200 pages of a4")));
  EXPECT_THAT(error(0.1, {"a4", 0.01, 0.08}), HasSubstr("smaller margins"));
  EXPECT_THAT(error_text([] {
                board_pdf(board_of("checkerboard", 6, 5, 0.11), {"a4", 0.01});
              }),
              HasSubstr("or tiles: 12 pages"));
}

// A cut through a corner would show in its place. Pages that hold less than they could leave cuts some room.
TEST(TilesOfABoard, AreCutAwayFromTheCorners) {
  BoardPrint print{"a4", 0.01};
  for (const double square_mm : {20.0, 60.0, 80.0, 110.0}) {
    const BoardSheet sheet = board_sheet(board_of("checkerboard", 24, 17, 1e-3 * square_mm), print.border_m);
    const std::optional<TilePlan> plan = best_tiles(sheet, print);
    ASSERT_TRUE(plan.has_value());
    for (const auto& cuts : {plan->cuts_x_mm, plan->cuts_y_mm})
      for (std::size_t i = 1; i + 1 < cuts.size(); ++i) {
        const double squares = (cuts[i] - 10.0) / square_mm;
        EXPECT_GT(square_mm * std::abs(squares - std::round(squares)), 2.0) << square_mm << " mm, cut " << i;
        EXPECT_LE(cuts[i + 1] - cuts[i], 266.5);
        EXPECT_GT(cuts[i], cuts[i - 1]);
      }
  }
}

}  // namespace
}  // namespace rigproof
