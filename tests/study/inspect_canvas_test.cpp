// What is written on pictures stays in its place, however long it is.
#include "inspect_canvas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "temp_folder.h"

namespace rigproof {
namespace {

using namespace inspect_detail;
using testing::EndsWith;
using testing::StartsWith;

// Where anything is drawn.
cv::Rect drawn(const Canvas& canvas) {
  const TempFolder folder;
  const cv::Mat grey = cv::imread(canvas.save(folder / "canvas.png").string(), cv::IMREAD_GRAYSCALE);
  return cv::boundingRect(grey < 250);
}

TEST(Canvas, LongTextIsCutToItsWidth) {
  EXPECT_EQ(Canvas::shortened("left", 9.0, 100.0), "left");
  const std::string cut = Canvas::shortened("front_left_camera_color_optical_frame", 9.0, 150.0);
  EXPECT_THAT(cut, StartsWith("front_left"));
  EXPECT_THAT(cut, EndsWith("..."));
  EXPECT_LE(Canvas::text_width(cut, 9.0), 150.0);
}

TEST(Canvas, ALegendBeginsBehindTheTitle) {
  constexpr double kLeft = 400.0;
  for (const std::size_t length : {4, 37, 64}) {
    const std::vector<std::string> names(8, std::string(length, 'm'));
    Canvas canvas(1200, 60);
    draw_camera_legend(&canvas, names, kLeft, 32.0);
    const cv::Rect place = drawn(canvas);
    EXPECT_GE(place.x, kLeft) << length;
    EXPECT_LE(place.br().x, canvas.width() - kMargin + 1.0) << length;
    EXPECT_GT(place.width, 400) << length;
  }
}

TEST(Canvas, ALongNameTakesTheRoomThatShortOnesLeave) {
  Canvas canvas(1200, 60);
  draw_camera_legend(&canvas, {std::string(30, 'm'), "a", "b"}, 400.0, 32.0);
  EXPECT_GT(drawn(canvas).width, Canvas::text_width(std::string(30, 'm'), 9.5));
}

}  // namespace
}  // namespace rigproof
