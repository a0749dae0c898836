#include "rigproof/core/data_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "error_text.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Data of the test's own, found through RIGPROOF_DATA.
struct OwnData : TempFolder {
  OwnData() {
    write("models/rigs/husky_3x_d455.yaml", "");
    write("models/rigs/cart_8x.yaml", "");
    write("scenes/indoor_lab.yaml", "");
    write("scenes/yard/scene.yaml", "");
    write("scenes/yard/parts.xml", "");
    write("config/budgets/ci.yaml", "");
    setenv("RIGPROOF_DATA", path().c_str(), 1);
  }
  ~OwnData() { unsetenv("RIGPROOF_DATA"); }
};

TEST(DataPath, ProgramsOfTheBuildTreeUseTheSourceTree) {
  unsetenv("RIGPROOF_DATA");
  EXPECT_TRUE(fs::exists(data_folder() / "models" / "sensors" / "d455.yaml"));
}

TEST(DataPath, PresetsAreFoundByName) {
  const OwnData data;
  EXPECT_EQ(find_data_file("rigs", "husky_3x_d455"), data / "models/rigs/husky_3x_d455.yaml");
  EXPECT_EQ(find_data_file("rigs", "husky_3x_d455.yaml"), data / "models/rigs/husky_3x_d455.yaml");
  EXPECT_EQ(find_data_file("scenes", "yard"), data / "scenes/yard/scene.yaml");
  EXPECT_EQ(find_data_file("config", "budgets/ci"), data / "config/budgets/ci.yaml");
  EXPECT_EQ(find_data_file("config", "budgets/ci.yaml"), data / "config/budgets/ci.yaml");
  EXPECT_THAT(list_presets("rigs"), testing::ElementsAre("cart_8x", "husky_3x_d455"));
  EXPECT_THAT(list_presets("scenes"), testing::ElementsAre("indoor_lab", "yard"));
  EXPECT_THAT(list_presets("robots"), testing::IsEmpty());
}

// Folders of one's own beside the program's: what they have comes first.
TEST(DataPath, FoldersOfTheUserComeFirst) {
  const OwnData data;
  const TempFolder mine, ours;
  mine.write("models/rigs/cart_8x.yaml", "");
  ours.write("models/rigs/cart_8x.yaml", "");
  ours.write("models/rigs/mower.yaml", "");
  setenv("RIGPROOF_PATH", (mine.path().string() + "::" + ours.path().string()).c_str(), 1);
  EXPECT_THAT(list_presets("rigs"), testing::ElementsAre("cart_8x", "husky_3x_d455", "mower"));
  EXPECT_EQ(find_preset("rigs", "cart_8x"), mine / "models/rigs/cart_8x.yaml");
  EXPECT_EQ(find_data_file("rigs", "mower"), ours / "models/rigs/mower.yaml");
  setenv("RIGPROOF_PATH", (mine / "nowhere").c_str(), 1);
  EXPECT_THAT(error_text([] { list_presets("rigs"); }), HasSubstr("RIGPROOF_PATH: "));
  unsetenv("RIGPROOF_PATH");
}

TEST(DataPath, AnExistingFileWinsOverAPreset) {
  const OwnData data;
  const fs::path file = data.write("mine/husky.yaml", "");
  EXPECT_EQ(find_data_file("rigs", file.string()), file);
  EXPECT_NE(error_text([&] { find_preset("rigs", file.string()); }), "") << "a preset's name is no path";
}

TEST(DataPath, UnknownNamesSayWhatThereIs) {
  const OwnData data;
  EXPECT_EQ(error_text([] { find_data_file("rigs", "husky_3xd455"); }),
            "there is no \"husky_3xd455\" among the presets of rigs; did you mean \"husky_3x_d455\"? known: cart_8x, "
            "husky_3x_d455");
  EXPECT_EQ(error_text([] { find_data_file("robots", "husky"); }),
            "there is no \"husky\" among the presets of robots; none is known");
  EXPECT_EQ(error_text([] { find_data_file("rigs", "/none/of/these.yaml"); }), "/none/of/these.yaml: no such file");
  EXPECT_EQ(error_text([] { find_data_file("rigs", "mine.yaml"); }), "mine.yaml: no such file");
  EXPECT_EQ(error_text([] { find_data_file("rigs", "cart_8.yaml"); }),
            "cart_8.yaml: no such file; did you mean the preset \"cart_8x\"?");
  EXPECT_THAT(error_text([] { find_data_file("rig", "x"); }), HasSubstr("did you mean \"rigs\"?"));
}

TEST(DataPath, FilesOfAFolderAreFoundByTheirNamesThere) {
  const OwnData data;
  const fs::path ci = data / "config/budgets/ci.yaml", file = data.write("mine/cii.yaml", "");
  for (const char* name : {"ci", "ci.yaml", "budgets/ci"}) EXPECT_EQ(find_config_file("budgets", name), ci) << name;
  EXPECT_EQ(find_config_file("budgets", file.string()), file);
  EXPECT_THAT(list_presets("config", "budgets"), testing::ElementsAre("ci"));
  EXPECT_EQ(error_text([] { find_config_file("budgets", "cii"); }),
            "there is no \"cii\" among the presets of config/budgets; did you mean \"ci\"? known: ci");
}

TEST(DataPath, AWrongRigproofDataIsNamed) {
  const OwnData data;
  setenv("RIGPROOF_DATA", (data / "config").c_str(), 1);
  EXPECT_THAT(error_text([] { data_folder(); }), HasSubstr("config: holds no folder models/"));
}

}  // namespace
}  // namespace rigproof
