// `rigproof bench export` as a user types it.
#include <nlohmann/json.hpp>

#include "cli_fixture.h"
#include "rigproof/core/files.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(BenchExport, GivesALayoutWithCommandsAndSumsAndTheTruthApart) {
  const TempFolder scratch;
  const ProcessOutput output = rigproof_command(
      {"bench", "export", small_run().string(), "--to", "mrcal", "-o", (scratch / "case").string(), "--json"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  const nlohmann::json json = nlohmann::json::parse(output.out);
  EXPECT_GT(json.at("images").get<int>(), 3);
  const fs::path layout = scratch / "case/mrcal";
  EXPECT_EQ(json.at("output").get<std::string>(), layout.string());
  EXPECT_EQ(read_whole_file(scratch / "case/truth.yaml"), read_whole_file(small_run() / "truth/truth.yaml"));
  const std::string readme = read_whole_file(layout / "README.md");
  EXPECT_THAT(readme, AllOf(HasSubstr("mrcal-calibrate-cameras"), Not(HasSubstr("{"))));
  const std::string sums = read_whole_file(layout / "SHA256SUMS");
  for (const auto& [name, content] : tree_content(layout)) {
    EXPECT_THAT(name, Not(HasSubstr("truth")));
    EXPECT_TRUE(name == "SHA256SUMS" || sums.find("  " + name + "\n") != std::string::npos) << name;
    if (fs::path(name).extension() == ".png") {
      EXPECT_EQ(content.at(25), 0) << name << ": of colour";
    }
  }
}

TEST(BenchExport, EveryLayoutHasItsInstructions) {
  const TempFolder scratch;
  for (const std::string layout : {"mcalib", "opencv", "euroc", "mcap", "colmap"}) {
    const ProcessOutput output =
        rigproof_command({"bench", "export", small_run().string(), "--to", layout, "-o", (scratch / "case").string()});
    ASSERT_EQ(output.exit_code, 0) << output.err;
    EXPECT_THAT(output.out, HasSubstr("what to run: "));
    EXPECT_TRUE(fs::exists(scratch / "case" / layout / "README.md")) << layout;
  }
}

TEST(BenchExport, RefusesWhatIsNoCaseAndWhatHasNoTruth) {
  const TempFolder scratch;
  ProcessOutput output =
      rigproof_command({"bench", "export", "clean_lap", "--to", "mrcal", "-o", (scratch / "a").string()});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, AllOf(HasSubstr("clean_lap"), HasSubstr("clean_lab")));
  output = rigproof_command(
      {"bench", "export", copy_of_recording(scratch).string(), "--to", "mrcal", "-o", (scratch / "b").string()});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("truth"));
  EXPECT_FALSE(fs::exists(scratch / "a"));
  EXPECT_FALSE(fs::exists(scratch / "b"));
}

// Answers to the layout that is there would be scored by a truth that is not theirs.
TEST(BenchExport, ReplacesNoTruthOfAnotherRun) {
  const TempFolder scratch;
  const fs::path truth = scratch / "case/truth.yaml";
  fs::create_directories(truth.parent_path());
  write_file_atomically(truth, std::string_view("of another run"));
  const ProcessOutput output =
      rigproof_command({"bench", "export", small_run().string(), "--to", "mrcal", "-o", (scratch / "case").string()});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("truth.yaml: is the truth of another run; name a new folder"));
  EXPECT_EQ(read_text_file(truth), "of another run");
  EXPECT_FALSE(fs::exists(scratch / "case/mrcal"));
}

// `-o clean_lab` leaves a folder of the case's name.
TEST(BenchExport, AFolderOfTheSameNameHidesNoCase) {
  const TempFolder scratch;
  fs::create_directories(scratch / "clean_lab/mrcal");
  const ProcessOutput output =
      rigproof_command({"bench", "export", "clean_lab", "--to", "opencv", "-o", "clean_lab", "--set", "posses=2"},
                       scratch.path().string());
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, AllOf(HasSubstr("posses"), Not(HasSubstr("not an input"))));
}

}  // namespace
}  // namespace rigproof
