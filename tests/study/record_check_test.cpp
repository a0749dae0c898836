// What is told of a drive while it is recorded: from files as they lie there, whole and half-written.
#include "rigproof/study/import/record_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "board_picture.h"
#include "error_text.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/image_cell.h"
#include "rigproof/core/text.h"
#include "rigproof/png/png_encoder.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const char* const kInfo =
    "image_width: 320\nimage_height: 240\ncamera_matrix: {rows: 3, cols: 3, data: [300, 0, 159.5, 0, 300, 119.5, 0, 0, "
    "1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n";

Camera lens() {
  Camera camera;
  camera.width_px = 320;
  camera.height_px = 240;
  camera.fx_px = camera.fy_px = 300.0;
  camera.cx_px = 159.5;
  camera.cy_px = 119.5;
  return camera;
}

std::string png_of(const Image8& image) {
  PngEncoder encoder;
  return std::string(encoder.encode(image));
}

// The board about the given pixel, small enough for a third of the image.
std::string board_at(double u, double v, double roll_rad = 0.0, const BoardPictureOptions& options = {}) {
  const Board board;
  return png_of(draw_board(lens(), board, board_in_view(lens(), board, 2.0, 0.2, 0.3, roll_rad, {u, v}), options));
}

std::string empty_picture() { return png_of(Image8(320, 240, 1, 128)); }

class Watched : public testing::Test {
 protected:
  void write_poses(const std::vector<double>& headings_deg) {
    poses_.clear();
    for (std::size_t i = 0; i < headings_deg.size(); ++i)
      poses_ += number_text(1000.25 + 2.0 * static_cast<double>(i)) + "," + number_text(0.1 * static_cast<double>(i)) +
                ",0," + number_text(deg_to_rad(headings_deg[i])) + "\n";
    scratch_.write("in/odometry.csv", "stamp_s,x_m,y_m,yaw_rad\n" + poses_);
  }
  fs::path picture(const std::string& camera, int stop, const std::string& bytes) {
    scratch_.write("in/" + camera + "/camera_info.yaml", kInfo);
    return scratch_.write("in/" + camera + "/" + number_text(1000.25 + 2.0 * stop) + ".png", bytes);
  }
  RecordCheckOptions options(bool growing = false) {
    RecordCheckOptions options;
    options.source.source = scratch_ / "in";
    options.growing = growing;
    return options;
  }
  RecordCheckOptions with_board(bool growing = false) {
    RecordCheckOptions with = options(growing);
    with.source.board = Board();
    return with;
  }
  RecordCheck looked() { return RecordWatch(with_board()).look(); }

  TempFolder scratch_;
  std::string poses_;
};

TEST_F(Watched, TellsOfEachCameraAndPair) {
  write_poses({0.0, 20.0, -20.0});
  for (int stop = 0; stop < 3; ++stop) {
    picture("left", stop, board_at(80.0 + 80.0 * stop, 120.0));
    picture("right", stop, stop == 1 ? empty_picture() : board_at(160.0, 120.0));
    picture("rear", stop, empty_picture());
  }
  const RecordCheck check = looked();
  EXPECT_EQ(check.stops, 3U);
  EXPECT_EQ(check.duration_s, 4.0);
  EXPECT_EQ(check.board, "checkerboard 5x4");
  EXPECT_FALSE(check.board_guessed);
  ASSERT_EQ(check.cameras.size(), 3U);
  const CameraCheck &left = check.cameras[0], &rear = check.cameras[1], &right = check.cameras[2];
  EXPECT_EQ(left.name, "left");
  EXPECT_EQ(left.board_stops, 3U);
  EXPECT_EQ(right.board_stops, 2U);
  EXPECT_EQ(rear.board_stops, 0U);
  EXPECT_EQ(rear.stops, 3U);
  EXPECT_EQ(rear.cells, 0U);
  ASSERT_EQ(rear.left_out.size(), 1U);
  EXPECT_TRUE(rear.left_out[0].is("board.not_found"));
  std::set<std::size_t> cells;
  for (int stop = 0; stop < 3; ++stop) {
    const Board board;
    for (const Eigen::Vector2d& corner :
         true_corners(lens(), board, board_in_view(lens(), board, 2.0, 0.2, 0.3, 0.0, {80.0 + 80.0 * stop, 120.0})))
      cells.insert(image_cell(lens(), corner));
  }
  EXPECT_EQ(left.cells, cells.size());
  EXPECT_GT(left.cells, right.cells);
  std::map<std::string, std::size_t> pairs;
  for (const PairCheck& pair : check.pairs) pairs[pair.first + "-" + pair.second] = pair.stops;
  EXPECT_EQ(pairs["left-right"], 2U);
  EXPECT_EQ(pairs["left-rear"], 0U);
}

// The headings tried so far go from -20 to 20 degrees: the middle of the others is behind.
TEST_F(Watched, TurnsCamerasThatHaveNotSeenTheBoardWhereTheyHaveNotLooked) {
  write_poses({0.0, 20.0, -20.0});
  for (int stop = 0; stop < 3; ++stop) {
    picture("front", stop, board_at(160.0, 120.0));
    picture("left", stop, empty_picture());
    picture("rear", stop, empty_picture());
  }
  const std::vector<Advice> next = looked().next;
  ASSERT_FALSE(next.empty());
  EXPECT_THAT(next[0].cameras, ElementsAre("left", "rear"));
  EXPECT_FALSE(next[0].part.has_value());
  EXPECT_TRUE(next[0].here);
  EXPECT_EQ(std::abs(next[0].turn_deg), 160.0);  // from -20 degrees to 180
}

// Done as it is told, the board comes to the middle of the third that it names.
TEST_F(Watched, NamesThePartOfTheImageThatIsMissingAndTheTurn) {
  write_poses({0.0, 0.0, 0.0});
  for (int stop = 0; stop < 3; ++stop) picture("front", stop, board_at(160.0 + 40.0 * stop, 120.0));
  const std::vector<Advice> next = looked().next;
  ASSERT_FALSE(next.empty());
  EXPECT_EQ(next[0].part, "left");
  EXPECT_EQ(next[0].stop, 2U);
  // From pixel 240 to the middle of the left third, 53: the camera turns to the right.
  const double expected_deg = rad_to_deg(std::atan((240.0 - 159.5) / 300.0) + std::atan((159.5 - 320.0 / 6.0) / 300.0));
  EXPECT_NEAR(next[0].turn_deg, -expected_deg, 1.5);  // whole degrees, and the corners' middle for the board's
}

// A camera on its side: a turn moves the board along the columns of its image. The others tell which way is up.
TEST_F(Watched, ACameraOnItsSideIsTurnedByItsOwnSense) {
  write_poses({0.0, 0.0});
  for (int stop = 0; stop < 2; ++stop) {
    picture("a", stop, board_at(80.0 + 160.0 * stop, 120.0));
    picture("b", stop, board_at(80.0 + 160.0 * stop, 120.0));
    picture("side", stop, board_at(160.0, 60.0, 0.5 * kPi));
  }
  for (const Advice& advice : looked().next) {
    if (advice.cameras.front() != "side") continue;
    EXPECT_EQ(advice.part, "lower");
    // The board's down points to the left of this image: what is on the robot's right is at its bottom, and a turn to
    // the left brings the board there; the other way round where it points to the right.
    const Board board;
    const std::vector<Eigen::Vector2d> corners =
        true_corners(lens(), board, board_in_view(lens(), board, 2.0, 0.2, 0.3, 0.5 * kPi, {160.0, 60.0}));
    const bool down_is_left = corners.back().x() < corners.front().x();
    EXPECT_GT(down_is_left ? advice.turn_deg : -advice.turn_deg, 5.0);
    return;
  }
  FAIL() << "nothing is told of the camera on its side";
}

TEST_F(Watched, TellsBlurAndExposure) {
  write_poses({0.0, 10.0, 20.0, 30.0});
  BoardPictureOptions blurred, white, dark;
  blurred.psf_sigma_px = 2.2;
  white.light = 255.0;
  dark.light = 45.0;
  dark.dark = 8.0;
  dark.background = 20.0;
  picture("left", 0, board_at(160.0, 120.0));
  picture("left", 1, board_at(160.0, 120.0, 0.0, blurred));
  picture("left", 2, board_at(160.0, 120.0, 0.0, white));
  picture("left", 3, board_at(160.0, 120.0, 0.0, dark));
  const RecordCheck check = looked();
  const CameraCheck& left = check.cameras[0];
  EXPECT_EQ(left.blurred, 1U);
  EXPECT_EQ(left.overexposed, 1U);
  EXPECT_EQ(left.underexposed, 1U);
  // Twice the blur: of the lens 0.6 px, of the pixel's own area sqrt(1/12).
  ASSERT_TRUE(check.pictures[0][0]->edge_px.has_value());
  EXPECT_NEAR(*check.pictures[0][0]->edge_px, 2.0 * std::hypot(0.6, std::sqrt(1.0 / 12.0)), 0.1);
}

TEST_F(Watched, FindsOutWhichBoardItIs) {
  write_poses({0.0, 10.0});
  picture("left", 0, empty_picture());
  picture("left", 1, board_at(160.0, 120.0));
  const RecordCheck check = RecordWatch(options()).look();
  EXPECT_EQ(check.board, "checkerboard 5x4");
  EXPECT_TRUE(check.board_guessed);
  EXPECT_EQ(check.cameras[0].board_stops, 1U);
}

// The first picture may show squares that are no board.
TEST_F(Watched, ASecondLookCorrectsTheFirst) {
  Board chance, marked;
  chance.squares_x = 4;
  chance.squares_y = 3;
  marked.type = "charuco";
  const auto picture_of = [](const Board& board, double u) {
    return png_of(draw_board(lens(), board, board_in_view(lens(), board, 1.0, 0.2, 0.3, 0.0, {u, 120.0}), {}));
  };
  write_poses({0.0, 20.0, -20.0});
  picture("left", 0, picture_of(chance, 150.0));
  RecordWatch watch(options(true));
  EXPECT_EQ(watch.look().board, "checkerboard 4x3");
  picture("left", 1, picture_of(marked, 160.0));
  picture("left", 2, picture_of(marked, 170.0));
  const RecordCheck check = watch.look();
  EXPECT_EQ(check.board, "charuco 5x4");
  EXPECT_TRUE(check.board_guessed);
  EXPECT_EQ(check.cameras[0].board_stops, 2U);
}

TEST_F(Watched, WaitsForWhatIsHalfWritten) {
  write_poses({0.0, 10.0});
  picture("left", 0, board_at(160.0, 120.0));
  const std::string whole = board_at(100.0, 120.0);
  const fs::path file = picture("left", 1, whole.substr(0, whole.size() / 2));
  EXPECT_EQ(looked().cameras[0].unreadable, 1U);
  EXPECT_EQ(looked().waiting, 0U);
  RecordWatch watch(with_board(true));
  const RecordCheck before = watch.look();
  EXPECT_EQ(before.waiting, 1U);
  EXPECT_EQ(before.cameras[0].unreadable, 0U);
  EXPECT_EQ(before.cameras[0].board_stops, 1U);
  std::ofstream(file, std::ios::binary) << whole;
  // A third stop, and a line of the trajectory that is not whole yet.
  picture("left", 2, board_at(200.0, 120.0));
  scratch_.write("in/odometry.csv", "stamp_s,x_m,y_m,yaw_rad\n" + poses_ + "1004.25,0.2,0,0\n1006.2");
  const RecordCheck after = watch.look();
  EXPECT_EQ(after.waiting, 0U);
  EXPECT_EQ(after.stops, 3U);
  EXPECT_EQ(after.cameras[0].board_stops, 3U);
}

TEST_F(Watched, TellsTheSameWithAnyNumberOfThreads) {
  std::vector<double> headings_deg(12, 0.0);
  write_poses(headings_deg);
  for (int stop = 0; stop < 12; ++stop) {
    picture("left", stop, stop % 4 == 3 ? empty_picture() : board_at(100.0 + 10.0 * stop, 120.0));
    picture("right", stop, stop % 5 == 4 ? std::string("no picture") : board_at(220.0 - 10.0 * stop, 110.0));
  }
  RecordCheckOptions one = with_board(), many = with_board();
  one.source.threads = 1;
  many.source.threads = 5;
  std::size_t steps = 0;
  many.progress = [&steps](std::size_t done, std::size_t of) { return of == 24 && done == steps++; };
  const RecordCheck a = RecordWatch(one).look(), b = RecordWatch(many).look();
  EXPECT_EQ(steps, 24U);
  ASSERT_EQ(a.pictures.size(), 12U);
  ASSERT_EQ(b.pictures.size(), 12U);
  for (std::size_t stop = 0; stop < 12; ++stop)
    for (std::size_t camera = 0; camera < 2; ++camera) {
      ASSERT_TRUE(a.pictures[stop][camera] && b.pictures[stop][camera]);
      const PictureCheck &x = *a.pictures[stop][camera], &y = *b.pictures[stop][camera];
      EXPECT_EQ(x.board, y.board);
      EXPECT_EQ(x.corners, y.corners);
      EXPECT_EQ(x.edge_px, y.edge_px);
    }
  EXPECT_EQ(b.cameras[0].board_stops, 9U);
  EXPECT_EQ(b.cameras[1].unreadable, 2U);
}

TEST_F(Watched, GrowsFromNothing) {
  fs::create_directories(scratch_ / "in");
  RecordWatch watch(with_board(true));
  EXPECT_THAT(error_text([&] { watch.look(); }), HasSubstr("trajectory"));
  write_poses({0.0, 10.0});
  EXPECT_THAT(error_text([&] { watch.look(); }), HasSubstr("no images"));
  picture("left", 0, board_at(160.0, 120.0));
  EXPECT_EQ(watch.look().cameras[0].board_stops, 1U);
}

// What two cameras see of different boards ties them by no stop.
TEST_F(Watched, CountsAnyBoardOfTheRig) {
  write_poses({0.0, 20.0, -20.0});
  const auto picture_of = [](const std::string& dictionary) {
    Board board;
    board.type = "charuco";
    board.dictionary = dictionary;
    return png_of(draw_board(lens(), board, board_in_view(lens(), board, 1.0, 0.2, 0.3, 0.0, {160.0, 120.0}),
                             BoardPictureOptions()));
  };
  const std::string one = picture_of("DICT_5X5_50"), other = picture_of("DICT_4X4_50");
  for (int stop = 0; stop < 3; ++stop) {
    picture("left", stop, one);
    picture("right", stop, stop == 0 ? one : other);
  }
  const std::string shape = "{type: charuco, squares: [5, 4], square_mm: 100, dictionary: ";
  scratch_.write("in/rig.yaml", "board: " + shape + "DICT_5X5_50}\nmore_boards: [" + shape +
                                    "DICT_4X4_50}]\ncameras:\n  left: {}\n  right: {}\n");
  const RecordCheck check = RecordWatch(options()).look();
  EXPECT_EQ(check.board, "charuco 5x4, charuco 5x4");
  ASSERT_EQ(check.cameras.size(), 2U);
  EXPECT_EQ(check.cameras[0].board_stops, 3U);
  EXPECT_EQ(check.cameras[1].board_stops, 3U);
  ASSERT_EQ(check.pairs.size(), 1U);
  EXPECT_EQ(check.pairs[0].stops, 1U);
}

TEST_F(Watched, MistakesAreNamed) {
  RecordCheckOptions nowhere = options();
  nowhere.source.source = scratch_ / "nowhere";
  EXPECT_THAT(error_text([&] { RecordWatch watch(nowhere); }), AllOf(HasSubstr("nowhere"), HasSubstr("no such")));
  nowhere.source.source = scratch_.write("a.txt", "text");
  EXPECT_THAT(error_text([&] { RecordWatch watch(nowhere); }), AllOf(HasSubstr("a.txt"), HasSubstr(".mcap")));
  write_poses({0.0, 10.0});
  picture("left", 0, board_at(160.0, 120.0));
  RecordCheckOptions topic = options();
  topic.source.topics = {"left=/left"};
  EXPECT_THAT(error_text([&] { RecordWatch watch(topic); }), HasSubstr("--topic"));
}

}  // namespace
}  // namespace rigproof
