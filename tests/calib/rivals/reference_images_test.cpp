// memroc_reference on images: its corners are those of OpenCV, whatever was observed.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "board_drive.h"
#include "board_picture.h"
#include "map_memory.h"
#include "rigproof/calib/methods/registry.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

struct PicturedDrive {
  SyntheticDrive drive;
  Recording recording;

  MethodInput input(PictureMemory* memory = nullptr) const {
    MethodInput input{drive.observations, &recording, 2};
    input.memory = memory;
    return input;
  }
};

// One camera without clouds; an image for every view.
PicturedDrive draw_drive(const TempFolder& folder) {
  DriveOptions options;
  options.cameras = 1;
  options.stops = 10;
  PicturedDrive made{make_drive(options), {}};
  Observations& observations = made.drive.observations;
  made.recording.folder = folder.path();
  made.recording.rig.cameras = observations.cameras;
  made.recording.frames.resize(1);
  BoardPictureOptions drawing;
  drawing.supersampling = 2;
  for (BoardView& view : observations.board_views) {
    const Rigid3 T_world_camera =
        made.drive.T_world_robot[static_cast<std::size_t>(view.stop)] * made.drive.T_robot_camera[0];
    const Image8 image = draw_board(observations.cameras[0].camera, observations.board,
                                    T_world_camera.inverse() * made.drive.T_world_board, drawing);
    view.file = std::to_string(view.stop) + ".png";
    cv::imwrite((folder / view.file).string(),
                cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())));
    // A cloud that cannot be read: the method only wants to know that there is one.
    made.recording.frames[0].push_back({view.file, "", "none.txt", view.stamp_s, 0.0, 0});
  }
  return made;
}

const Method& reference() { return find_method("memroc_reference"); }

std::vector<double> numbers(const Result& result) {
  std::vector<double> list;
  for (const EstimatedTransform& camera : result.camera_to_robot) {
    const Eigen::Matrix4d matrix = camera.T_parent_child.matrix();
    list.insert(list.end(), matrix.data(), matrix.data() + matrix.size());
  }
  return list;
}

TEST(MemrocReferenceImages, CountInsteadOfWhatWasObserved) {
  const TempFolder folder;
  PicturedDrive made = draw_drive(folder);
  const Result result = run_method(reference(), made.input());
  ASSERT_EQ(result.camera_to_robot.size(), 1U);
  ASSERT_EQ(result.use.size(), 1U);
  EXPECT_EQ(result.use[0].used + static_cast<int>(result.use[0].left_out.size()), 10);
  EXPECT_GE(result.use[0].used, 6);
  // Its corners are good to a tenth of a pixel, not to the last digit.
  EXPECT_GT(result.use[0].reprojection_rms_px, 1e-3);
  EXPECT_LT(result.use[0].reprojection_rms_px, 0.2);
  const Result observed = run_method(reference(), {made.drive.observations});
  EXPECT_NE(numbers(observed), numbers(result));

  // Views that observing left out are searched as well, and corners that it got wrong do no harm.
  Observations& observations = made.drive.observations;
  observations.exclusions.push_back({0, observations.board_views.front().stop, observations.board_views.front().file,
                                     Finding("board.not_found"), false});
  observations.board_views.erase(observations.board_views.begin());
  for (BoardView& view : observations.board_views)
    for (CornerObservation& corner : view.corners) corner.pixel += Eigen::Vector2d(3.0 * corner.id, -2.0);
  const Result again = run_method(reference(), made.input());
  EXPECT_EQ(numbers(again), numbers(result));
  EXPECT_EQ(again.use[0].used, result.use[0].used);
}

TEST(MemrocReferenceImages, ServeMlToo) {
  const TempFolder folder;
  const PicturedDrive made = draw_drive(folder);
  const Result theirs = run_method(find_method("ml_opencv_corners"), made.input());
  const Result ours = run_method(find_method("ml"), made.input());
  ASSERT_EQ(theirs.camera_to_robot.size(), 1U) << testing::PrintToString(theirs.reasons);
  ASSERT_TRUE(theirs.camera_to_robot[0].fully_observable());
  const auto error = [&](const Result& result) {
    return transform_error(result.camera_to_robot[0].T_parent_child, made.drive.T_robot_camera[0]);
  };
  // Corners of some hundredths of a pixel on a board two metres away; the observed ones have no noise.
  EXPECT_LT(error(theirs).head<3>().norm(), 0.005);
  EXPECT_LT(error(theirs).tail<3>().norm(), 0.002);
  EXPECT_GT(error(theirs).norm(), 2.0 * error(ours).norm());
}

TEST(MemrocReferenceImages, AreSearchedOnce) {
  const TempFolder folder;
  const PicturedDrive made = draw_drive(folder);
  MapMemory memory;
  const std::vector<double> first = numbers(run_method(reference(), made.input(&memory)));
  EXPECT_EQ(memory.kept[PictureMemory::Finding::kChessboards], 10);
  EXPECT_EQ(numbers(run_method(reference(), made.input(&memory))), first);
  EXPECT_EQ(memory.recalled[PictureMemory::Finding::kChessboards], 10);
  EXPECT_EQ(memory.kept[PictureMemory::Finding::kBoardPoses], 10);
  EXPECT_EQ(memory.recalled[PictureMemory::Finding::kBoardPoses], 10);
  EXPECT_EQ(numbers(run_method(reference(), made.input())), first);
  memory.damage();
  EXPECT_EQ(numbers(run_method(reference(), made.input(&memory))), first);
  EXPECT_EQ(memory.kept[PictureMemory::Finding::kChessboards], 20);
  EXPECT_EQ(memory.kept[PictureMemory::Finding::kBoardPoses], 20);
}

TEST(MemrocReferenceImages, ThatCannotBeReadLeaveTheObservedCorners) {
  const TempFolder folder;
  const PicturedDrive made = draw_drive(folder);
  const std::vector<double> observed = numbers(run_method(reference(), {made.drive.observations}));
  for (const CameraFrame& frame : made.recording.frames[0]) std::filesystem::remove(folder / frame.color_file);
  Observations without_planes = made.drive.observations;
  without_planes.ground_planes.clear();  // there is no cloud that can be read either
  const std::vector<double> unread = numbers(run_method(reference(), made.input()));
  EXPECT_EQ(unread, numbers(reference().solve(without_planes)));
  EXPECT_NE(unread, observed);
}

}  // namespace
}  // namespace rigproof
