// Folders of images with a trajectory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/text.h"
#include "rigproof/png/png_encoder.h"
#include "rigproof/study/import/init.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

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

TEST_F(InitFolder, SeveralTrajectoriesAreAskedAbout) {
  scratch_.write("in/other.txt", scratch_.read("in/poses.tum"));
  EXPECT_THAT(failure(), HasSubstr("--odometry FILE"));
  options_.odometry = scratch_ / "in/other.txt";
  EXPECT_EQ(init_recording(options_).odometry, "other.txt");
}

}  // namespace
}  // namespace rigproof
