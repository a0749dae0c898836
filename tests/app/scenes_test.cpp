// Worlds: those that ship, a user's own from another folder with a picture as its floor, and data sets of several.
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "cli_fixture.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// The world of docs/guides/worlds.md: two files and a picture.
constexpr const char* kYaml = R"(description: "Our hall"
mjcf: my_hall.xml
drivable_area: {x_min_m: -4, x_max_m: 4, y_min_m: -3, y_max_m: 3}
board: {x_m: {uniform: [3.4, 3.8]}, y_m: 0, z_m: 0.7, facing_deg: 180, lean_deg: 8}
straight_path: {x_m: 2.5, y_m: 0, heading_deg: 180, length_m: 5}
textures:
  - {name: hall_floor, type: file, file: floor.png, size_px: 512}
  - {name: hall_wall, type: plaster, color: [0.8, 0.8, 0.7]}
  - {name: hall_oak, type: wood, cube: true, size_px: 256}
objects:
  - {kind: table, place_m: [5, 2], heading_deg: 90, texture: hall_oak}
scatter:
  - {kind: box, count: {uniform: [2, 5]}, x_m: {uniform: [4.8, 5.8]}, y_m: {uniform: [-4, 1]}}
)";
constexpr const char* kMjcf = R"(<mujoco model="my_hall">
  <asset>
    <material name="hall_floor" texture="hall_floor" texrepeat="0.5 0.5" texuniform="true" specular="0"/>
    <material name="hall_wall" texture="hall_wall" texrepeat="0.5 0.5" texuniform="true" specular="0"/>
  </asset>
  <worldbody>
    <light directional="true" pos="0 0 3" dir="0.5 0.3 -0.8" castshadow="false" diffuse="0.5 0.5 0.5" ambient="0.4 0.4 0.4"/>
    <geom name="floor" type="plane" size="7 6 1" material="hall_floor"/>
    <geom name="wall_east" type="box" pos="6.5 0 1.5" size="6 1.5 0.05" xyaxes="0 -1 0 0 0 1" material="hall_wall"/>
  </worldbody>
</mujoco>
)";

class MyHall : public testing::Test {
 protected:
  MyHall() {
    folder_.write("my_hall.yaml", kYaml);
    folder_.write("my_hall.xml", kMjcf);
    cv::Mat floor(300, 400, CV_8UC3);
    cv::randu(floor, cv::Scalar(60, 60, 60), cv::Scalar(200, 200, 200));
    cv::imwrite((folder_ / "floor.png").string(), floor);
  }
  ProcessOutput try_out() const {
    return rigproof_command({"scenes", (folder_ / "my_hall.yaml").string(), "--poses", "4", "-o", picture().string()});
  }
  fs::path picture() const { return folder_ / "look.png"; }
  void expect_error(const std::string& words) const {
    const ProcessOutput output = try_out();
    EXPECT_EQ(output.exit_code, 2) << output.out;
    EXPECT_THAT(output.err, HasSubstr(words));
  }

  TempFolder folder_;
};

TEST_F(MyHall, IsTriedOutAndShown) {
  const ProcessOutput output = try_out();
  EXPECT_EQ(output.exit_code, 0) << output.out << output.err;
  EXPECT_THAT(output.out, AllOf(HasSubstr("my_hall"), HasSubstr("ok")));
  EXPECT_GT(cv::imread(picture().string()).cols, 700);
}

TEST_F(MyHall, WithoutItsPictureIsRefused) {
  fs::remove(folder_ / "floor.png");
  expect_error("textures: a list of 3: hall_floor: there is no image floor.png beside the scene");
}

TEST_F(MyHall, WithoutAFloorIsRefused) {
  std::string text = kMjcf;
  text.replace(text.find("name=\"floor\""), 12, "name=\"ground\"");
  folder_.write("my_hall.xml", text);
  expect_error("the scene has no floor");
}

TEST_F(MyHall, WithImpossibleValuesIsRefusedWithAllOfThem) {
  std::string text = kYaml;
  text.replace(text.find("x_max_m: 4"), 10, "x_max_m: -9");
  text.replace(text.find("length_m: 5"), 11, "length_m: -5");
  folder_.write("my_hall.yaml", text);
  expect_error("drivable_area");
  expect_error("straight_path.length_m");
}

TEST(DataSetCommand, MakesARunOfEachWorldAndResumes) {
  const TempFolder scratch;
  const std::vector<std::string> command = {
      "generate", "-o",    (scratch / "set").string(), "--set", "scenes=[home, meadow]",  "--set",
      "poses=2",  "--set", "image_scale=0.1",          "--set", "straight_drive.frames=3"};
  const ProcessOutput first = rigproof_command(command);
  EXPECT_EQ(first.exit_code, 0) << first.err;
  for (const char* world : {"set/home/", "set/meadow/"}) {
    EXPECT_TRUE(fs::is_regular_file(scratch / (std::string(world) + "run.yaml"))) << world;
    EXPECT_TRUE(fs::is_regular_file(scratch / (std::string(world) + "recording/segments.csv"))) << world;
  }
  EXPECT_THAT(rigproof_command(command).out, HasSubstr("all there already"));
  const ProcessOutput run =
      rigproof_command({"run", "--set", "scenes=[home, meadow]", "-o", (scratch / "run").string()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("makes 2 runs"));
}

}  // namespace
}  // namespace rigproof
