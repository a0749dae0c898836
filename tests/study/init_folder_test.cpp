// Folders of images with a trajectory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "board_picture.h"
#include "error_text.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/text.h"
#include "rigproof/formats/frame_tree.h"
#include "rigproof/png/png_encoder.h"
#include "rigproof/study/import/init.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const char* const kInfo =
    "image_width: 16\nimage_height: 12\ncamera_matrix: {rows: 3, cols: 3, data: [20, 0, 7.5, 0, 20, 5.5, 0, 0, 1]}\n"
    "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n";

// Four stops, a pose and an image each.
class InitFolder : public testing::Test {
 protected:
  InitFolder() {
    PngEncoder encoder;
    const std::string png(encoder.encode(Image8(16, 12, 1, 128))), depth(encoder.encode(Image16(16, 12, 1, 2000)));
    std::string poses;
    for (int i = 0; i < 4; ++i) {
      const std::string stamp = std::to_string(1700000000 + i) + ".25";
      poses += stamp + " " + number_text(0.5 * i) + " 0 0 0 0 0 1\n";
      scratch_.write("in/left/" + stamp + ".png", png);
      scratch_.write("in/left/depth/" + stamp + ".png", depth);
      scratch_.write("in/right/image/" + std::to_string(i) + ".png", png);
    }
    scratch_.write(
        "in/right/frames.csv",
        "file,stamp_s\n0.png,1700000000.25\n1.png,1700000001.25\n2.png,1700000002.25\n3.png,1700000003.25\n");
    scratch_.write("in/poses.tum", poses);
    for (const char* camera : {"left", "right"})
      scratch_.write(std::string("in/") + camera + "/camera_info.yaml", kInfo);
    options_.source = scratch_ / "in";
    options_.output = scratch_ / "out";
    options_.board = Board();
    options_.board->type = "aprilgrid";  // of the kinds the quickest not to be found
  }
  std::string failure() {
    const std::string text = error_text([&] { init_recording(options_); });
    EXPECT_FALSE(fs::exists(options_.output));
    EXPECT_FALSE(fs::exists(options_.output.string() + ".partial"));
    return text;
  }

  /// Intrinsics of what picture_of() makes.
  void write_infos_of_pictures() {
    for (const char* camera : {"left", "right"})
      scratch_.write(
          std::string("in/") + camera + "/camera_info.yaml",
          "image_width: 320\nimage_height: 240\ncamera_matrix: {rows: 3, cols: 3, data: [300, 0, 159.5, 0, 300, "
          "119.5, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, "
          "0, 0, 0, 0]}\n");
  }

  TempFolder scratch_;
  InitOptions options_;
};

TEST_F(InitFolder, BecomesARecording) {
  const InitReport report = init_recording(options_);
  EXPECT_EQ(report.odometry, "poses.tum");
  const Recording recording = load_recording(scratch_ / "out");
  ASSERT_EQ(recording.frames.size(), 2U);
  ASSERT_EQ(recording.frames[1].size(), 4U);
  EXPECT_EQ(recording.frames[1][2].stamp_s, 1700000002.25);
  EXPECT_EQ(recording.frames[0][3].depth_file, "left/depth/000003.png");
  EXPECT_FALSE(recording.rig.cameras[1].depth);
  EXPECT_EQ(recording.odometry[3].x_m, 1.5);
}

std::string picture_of(const Board& board, double column = 160.0) {
  const Camera camera = Camera::symmetric(320, 240, 300.0);
  PngEncoder encoder;
  return std::string(
      encoder.encode(draw_board(camera, board, board_in_view(camera, board, 1.0, 0.2, 0.3, 0.0, {column, 120.0}))));
}

// Whether or not one of them is known.
TEST_F(InitFolder, BoardsBesideTheFirstAreNamed) {
  Board ahead;
  ahead.type = "charuco";
  ahead.dictionary = "DICT_5X5_50";
  Board behind = ahead;
  behind.dictionary = "DICT_4X4_50";
  fs::remove_all(scratch_ / "in/left/depth");
  for (int i = 0; i < 4; ++i) {
    scratch_.write("in/left/" + std::to_string(1700000000 + i) + ".25.png", picture_of(ahead, 160.0 + i));
    scratch_.write("in/right/image/" + std::to_string(i) + ".png", picture_of(i == 0 ? ahead : behind, 170.0 + i));
  }
  write_infos_of_pictures();
  const auto names_second =
      AllOf(HasSubstr("more_boards: [{type: charuco, squares: [5, 4], square_mm: 100, marker_mm: 7"),
            HasSubstr("dictionary: DICT_4X4_50}]"));
  options_.board.reset();
  const InitReport guessed = init_recording(options_);
  ASSERT_EQ(guessed.missing.size(), 2U);
  EXPECT_THAT(guessed.missing[0], AllOf(HasSubstr("`board: {type: charuco"), HasSubstr("DICT_5X5_50")));
  EXPECT_THAT(guessed.missing[1], names_second);
  EXPECT_EQ(guessed.cameras[0].board_stops, 4U) << "of the boards that were guessed";
  EXPECT_EQ(guessed.cameras[1].board_stops, 4U);
  options_.board = ahead;
  options_.output = scratch_ / "known";
  EXPECT_THAT(init_recording(options_).notes,
              Contains(AllOf(HasSubstr("beside the board another one seems to be there"), names_second)))
      << "right sees the first once";
  scratch_.write("in/right/image/0.png", picture_of(behind));
  options_.output = scratch_ / "blind";
  EXPECT_THAT(init_recording(options_).notes,
              Contains(AllOf(HasSubstr("where right never sees the board another one seems to be"), names_second)));
}

// Ids that are read are no chance; squares may be.
TEST_F(InitFolder, MarkersSpeakLouderThanSquares) {
  Board marked, chance;
  marked.type = "charuco";
  marked.dictionary = "DICT_5X5_50";
  chance.squares_x = 4;
  chance.squares_y = 3;
  fs::remove_all(scratch_ / "in/left/depth");
  for (int i = 0; i < 4; ++i) {
    scratch_.write("in/left/" + std::to_string(1700000000 + i) + ".25.png", picture_of(chance, 150.0 + i));
    scratch_.write("in/right/image/" + std::to_string(i) + ".png",
                   i < 2 ? picture_of(marked, 160.0 + i) : picture_of(chance, 170.0 + i));
  }
  write_infos_of_pictures();
  options_.board.reset();
  const InitReport report = init_recording(options_);
  EXPECT_THAT(report.missing, ElementsAre(HasSubstr("`board: {type: charuco, squares: [5, 4]")));
  EXPECT_EQ(report.cameras[0].board_stops, 0U);
  EXPECT_EQ(report.cameras[1].board_stops, 2U);
}

// That is not the same as a board that is in no image.
TEST_F(InitFolder, WhyImagesCannotBeLookedAtIsSaid) {
  Board board;
  board.type = "charuco";
  board.dictionary = "DICT_5X5_50";
  fs::remove_all(scratch_ / "in/left/depth");
  for (int i = 0; i < 4; ++i) {
    scratch_.write("in/left/" + std::to_string(1700000000 + i) + ".25.png", picture_of(board));
    scratch_.write("in/right/image/" + std::to_string(i) + ".png", picture_of(board));
  }
  write_infos_of_pictures();
  options_.board = board;
  const InitReport report = init_recording(options_);
  EXPECT_THAT(report.notes,
              Contains(AllOf(HasSubstr("the board could not be looked for"), HasSubstr(": " + options_.output.string()),
                             HasSubstr("is the same image as left/color/"), Not(HasSubstr(".partial")))));
  EXPECT_THAT(report.notes, Not(Contains(HasSubstr("the board is in no image"))));
  EXPECT_FALSE(report.cameras[0].board_stops);
  EXPECT_EQ(load_recording(options_.output).frames[1].size(), 4U);
}

// Images of a folder are copied as they are.
TEST_F(InitFolder, ALensThatNobodyFollowsIsRefusedAndOneThatIsMetIsSaid) {
  const auto write = [&](const std::string& size_and_matrix, const std::string& d) {
    scratch_.write("in/left/camera_info.yaml",
                   size_and_matrix + "\ndistortion_model: rational_polynomial\nd: " + d + "\n");
  };
  write("width: 640\nheight: 480\nk: [500, 0, 320, 0, 500, 240, 0, 0, 1]", "[4, 0, 0, 0, 0, 8, 0, 0]");
  EXPECT_THAT(failure(), AllOf(HasSubstr("camera left"), HasSubstr("images of a folder are copied")));
  write("width: 16\nheight: 12\nk: [20, 0, 7.5, 0, 20, 5.5, 0, 0, 1]", "[0, 0, 0, 0, 0, 0.1, 0, 0]");
  EXPECT_THAT(init_recording(options_).notes, Contains(HasSubstr("left: rational_polynomial is written as")));
}

// Folders have no topics: cameras go by their names, whatever the chain was calibrated with.
TEST_F(InitFolder, ACamchainGoesByNames) {
  for (const char* camera : {"left", "right"})
    fs::remove(scratch_ / ("in/" + std::string(camera) + "/camera_info.yaml"));
  fs::rename(scratch_ / "in/left", scratch_ / "in/cam0");
  fs::rename(scratch_ / "in/right", scratch_ / "in/cam1");
  const std::string lens =
      ": {camera_model: pinhole, resolution: [16, 12], intrinsics: [20, 20, 7.5, 5.5], distortion_model: none, "
      "rostopic: ";
  options_.camera_infos = {
      scratch_
          .write("camchain.yaml",
                 "cam0" + lens + "/cam1}\ncam1" + lens +
                     "/cam0, T_cn_cnm1: [[1, 0, 0, -0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}\n")
          .string()};
  init_recording(options_);
  const auto T_cam0_cam1 = load_frame_tree(options_.output / "camchain.json").between("cam0", "cam1");
  ASSERT_TRUE(T_cam0_cam1);
  EXPECT_LT((T_cam0_cam1->translation - Eigen::Vector3d(0.5, 0.0, 0.0)).norm(), 1e-9);
}

TEST_F(InitFolder, EveryMissingPieceIsSaid) {
  for (const char* camera : {"left", "right"}) fs::remove(scratch_ / "in" / camera / "camera_info.yaml");
  EXPECT_THAT(failure(),
              AllOf(HasSubstr("camera left"), HasSubstr("camera right"), HasSubstr("--camera-info left=FILE")));
  fs::remove(scratch_ / "in/poses.tum");
  EXPECT_THAT(failure(), HasSubstr("holds no trajectory"));
  fs::remove_all(scratch_ / "in/left");
  fs::remove_all(scratch_ / "in/right");
  EXPECT_THAT(failure(), HasSubstr("holds no bag, no images"));
}

TEST_F(InitFolder, NamesWithoutStampsAndOtherClocksAreRefused) {
  fs::remove(scratch_ / "in/right/frames.csv");
  EXPECT_THAT(failure(), AllOf(HasSubstr("4 images have no stamp"), HasSubstr("frames.csv")));
  scratch_.write("in/right/frames.csv", "file,stamp_s\n0.png,10.25\n1.png,11\n2.png,12\n3.png,13\n");
  EXPECT_THAT(failure(), AllOf(HasSubstr("camera right"), HasSubstr("one clock")));
}

TEST_F(InitFolder, PosesThatLieOnTheirSideAreRefused) {
  scratch_.write("in/poses.tum",
                 "1700000000 0 0 0 0.7071068 0 0 0.7071068\n1700000009 1 0 0 0.7071068 0 0 0.7071068\n");
  EXPECT_THAT(failure(), HasSubstr("z does not point up"));
}

TEST_F(InitFolder, ColumnsThatNobodyNamesAreAskedAbout) {
  fs::remove(scratch_ / "in/poses.tum");
  const std::string rows = "1700000000,0,0,0\n1700000001.25,0.5,0,0\n1700000004,1.5,0,0\n";
  scratch_.write("in/odometry.csv", rows);
  EXPECT_THAT(failure(),
              AllOf(HasSubstr("odometry.csv:1: what are its columns?"), HasSubstr("stamp_s,x_m,y_m,yaw_rad")));
  scratch_.write("in/odometry.csv", "stamp_s,x_m,y_m,yaw_rad\n" + rows);
  EXPECT_EQ(init_recording(options_).odometry_rows, 3U);
}

// Not that there is none.
TEST_F(InitFolder, WhatIsWrongWithTheOnlyTrajectoryIsSaid) {
  const std::string good = scratch_.read("in/poses.tum");
  for (const auto& [row, words] : {std::pair{"1700000009 nan 0 0 0 0 0 1\n", "poses.tum:5: nan: must be a finite"},
                                   std::pair{"1700000009 1 0 0 0 0 0 0\n", "poses.tum:5: quaternion: has the norm 0"},
                                   std::pair{"1600000000 1 0 0 0 0 0 1\n", "does not come after the stamp before"}}) {
    scratch_.write("in/poses.tum", good + row);
    EXPECT_THAT(failure(), HasSubstr(words));
  }
  scratch_.write("in/good.txt", good);
  EXPECT_EQ(init_recording(options_).odometry, "good.txt") << "the other one is none";
}

TEST_F(InitFolder, SeveralTrajectoriesAreAskedAbout) {
  scratch_.write("in/other.txt", scratch_.read("in/poses.tum"));
  EXPECT_THAT(failure(), HasSubstr("--odometry FILE"));
  options_.odometry = scratch_ / "in/other.txt";
  EXPECT_EQ(init_recording(options_).odometry, "other.txt");
}

}  // namespace
}  // namespace rigproof
