// What methods find in images, kept and found again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "map_memory.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/calib/vision/feature_source.h"
#include "rigproof/calib/vision/image_findings.h"
#include "room.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using Finding = PictureMemory::Finding;

// One camera, which goes straight and then turns.
RoomDrive drive_in(const TempFolder& folder, int straight, int turns) {
  Steps steps(planar_pose(-2.0, -0.8, 0.1));
  steps.forward(0.15, straight);
  steps.arc(0.12, 9.0, turns);
  return drive_through_room(steps.poses, {two_cameras()[0]}, false, folder.path());
}

int pairs_of(const RoomDrive& drive) { return static_cast<int>(drive.observations.stops.size()) - 1; }

// All that is estimated, to the bit.
std::vector<double> numbers(const Result& result) {
  std::vector<double> list;
  for (const EstimatedTransform& camera : result.camera_to_robot) {
    const auto& T = camera.T_parent_child;
    list.insert(list.end(), T.rotation.coeffs().data(), T.rotation.coeffs().data() + 4);
    list.insert(list.end(), T.translation.data(), T.translation.data() + 3);
  }
  return list;
}

TEST(ImageMemory, MethodsThatFollowFeaturesShareMatchesAndMotions) {
  const TempFolder folder;
  const RoomDrive drive = drive_in(folder, 3, 3);
  MapMemory memory;
  const auto features = sift_features(1000);
  MethodInput plain{drive.observations, &drive.recording, 2};
  plain.features = features.get();
  MethodInput remembered = plain;
  remembered.memory = &memory;
  const int pairs = pairs_of(drive);
  run_method(find_method("robot_autocalib"), remembered);
  EXPECT_EQ(memory.kept[Finding::kMatches], pairs);
  EXPECT_EQ(memory.kept[Finding::kMotions], pairs);
  EXPECT_EQ(memory.recalled[Finding::kMatches], 0);

  const std::vector<double> x2car = numbers(run_method(find_method("sensorx2car"), plain));
  ASSERT_FALSE(x2car.empty());
  EXPECT_EQ(numbers(run_method(find_method("sensorx2car"), remembered)), x2car);
  EXPECT_EQ(memory.kept[Finding::kMatches], pairs) << "all known from the other method";
  EXPECT_GT(memory.recalled[Finding::kMotions], 0);

  // Damaged findings are found again.
  memory.damage();
  EXPECT_EQ(numbers(run_method(find_method("sensorx2car"), remembered)), x2car);
  EXPECT_GT(memory.kept[Finding::kMatches], pairs);
}

TEST(ImageMemory, NothingIsKeptOfFilesThatNobodyKnowsOrOfUnknownSources) {
  class Anonymous : public FeatureSource {
   public:
    ImageFeatures detect(const Image8& grey) const override { return sift_features()->detect(grey); }
  };
  const TempFolder folder;
  const RoomDrive drive = drive_in(folder, 2, 0);
  MapMemory memory;
  MethodInput input{drive.observations, &drive.recording, 2};
  input.memory = &memory;
  memory.known = false;
  run_method(find_method("robot_autocalib"), input);
  memory.known = true;
  const Anonymous anonymous;
  input.features = &anonymous;
  run_method(find_method("robot_autocalib"), input);
  EXPECT_TRUE(memory.kept.empty());
}

TEST(ImageMemory, ImagesThatCannotBeReadAreAskedAgain) {
  const TempFolder folder;
  RoomDrive drive = drive_in(folder, 0, 3);
  const std::filesystem::path image = drive.recording.folder / drive.recording.frames[0][1].color_file;
  const std::filesystem::path aside = folder / "aside.png";
  std::filesystem::rename(image, aside);
  MapMemory memory;
  MethodInput input{drive.observations, &drive.recording, 1};
  input.memory = &memory;
  run_method(find_method("robot_autocalib"), input);
  EXPECT_EQ(memory.kept[Finding::kMatches], pairs_of(drive) - 2) << "the image is in two pairs";
  std::filesystem::rename(aside, image);
  run_method(find_method("robot_autocalib"), input);
  EXPECT_EQ(memory.kept[Finding::kMatches], pairs_of(drive));
}

TEST(ImageFindings, BytesReadBackAndDamageIsSeen) {
  const std::vector<rivals::PixelMatch> matches = {{{1.5, 2.25}, {3.1, 4.7}}, {{0.0, 0.1}, {1e3, 7.0}}};
  std::vector<rivals::PixelMatch> read_matches;
  ASSERT_TRUE(read_bytes(rivals::bytes_of(matches), &read_matches));
  ASSERT_EQ(read_matches.size(), 2U);
  EXPECT_EQ(read_matches[1].b, matches[1].b);

  rivals::FoundMotion motion, read_motion;
  motion.T_a_b = Rigid3(so3_exp({0.1, 0.2, 0.3}), {0.6, 0.0, 0.8});
  motion.agrees = {true, false, true};
  ASSERT_TRUE(read_bytes(rivals::bytes_of(motion), &read_motion));
  EXPECT_EQ(read_motion.T_a_b->translation, motion.T_a_b->translation);
  EXPECT_EQ(read_motion.T_a_b->rotation.coeffs(), motion.T_a_b->rotation.coeffs());
  EXPECT_EQ(read_motion.agrees, motion.agrees);

  const std::optional<rivals::CloudPlane> plane = rivals::CloudPlane{{0.0, -1.0, 0.0}, 0.7};
  std::optional<rivals::CloudPlane> read_plane;
  ASSERT_TRUE(read_bytes(rivals::bytes_of(plane), &read_plane));
  EXPECT_EQ(read_plane->d, 0.7);

  for (const std::string& bytes : {rivals::bytes_of(matches), rivals::bytes_of(motion), rivals::bytes_of(plane)})
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const std::string cut = bytes.substr(0, size);
      EXPECT_FALSE(read_bytes(cut, &read_matches) || read_bytes(cut, &read_motion) || read_bytes(cut, &read_plane));
    }
}

TEST(Rivals, EveryMethodThatNeedsImagesSaysSoAndIsKnownToReadThem) {
  const Observations nothing;
  for (const Method* method : all_methods()) {
    const std::optional<rigproof::Finding> why_not = method->why_not({nothing});
    const bool says_so = why_not && why_not->is("method.needs_images");
    const bool needs_images = method->traits().needs.rfind("images", 0) == 0;
    EXPECT_EQ(says_so, needs_images) << method->traits().name << ": " << (why_not ? why_not->code : "");
    if (!needs_images) continue;
    EXPECT_NE(method->traits().reads, MethodReads::kObservations) << method->traits().name;
    EXPECT_EQ(run_method(*method, {nothing}).status, ResultStatus::kRefused);
  }
  // These read clouds where there are some.
  for (const char* name : {"memroc_reference", "joint_memroc_reference"})
    EXPECT_EQ(find_method(name).traits().reads, MethodReads::kFiles);
  for (const char* name : {"ml", "memroc", "joint_memroc", "li", "robot_autocalib_board", "opencv_park"})
    EXPECT_EQ(find_method(name).traits().reads, MethodReads::kObservations) << name;
}

}  // namespace
}  // namespace rigproof
