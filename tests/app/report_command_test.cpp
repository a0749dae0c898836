// `rigproof report` as a user types it.
#include <nlohmann/json.hpp>
#include <regex>

#include "cli_fixture.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TEST(ReportCommand, WritesOneFileOfARecording) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  ASSERT_EQ(rigproof_command({"calibrate", recording.string(), "-q"}).exit_code, 0);
  const ProcessOutput output = rigproof_command({"report", recording.string()});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.out, HasSubstr((recording / "report.html").string()));
  EXPECT_THAT(read_whole_file(recording / "report.html"), AllOf(HasSubstr("\"word\":\"GOOD\""), HasSubstr("</html>")));
  const ProcessOutput json =
      rigproof_command({"report", recording.string(), "-o", (scratch / "r.html").string(), "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out)["report"], (scratch / "r.html").string());
}

TEST(ReportCommand, SaysWhatIsMissing) {
  const TempFolder scratch;
  const ProcessOutput nowhere = rigproof_command({"report", (scratch / "nowhere").string()});
  EXPECT_EQ(nowhere.exit_code, 2);
  EXPECT_THAT(nowhere.err, HasSubstr("nowhere"));
  const fs::path recording = copy_of_recording(scratch);
  const ProcessOutput without = rigproof_command({"report", recording.string()});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("holds no result; make one with: rigproof calibrate"));
  EXPECT_FALSE(fs::exists(recording / "report.html"));
  fs::create_directory(recording / "results");
  write_whole_file(recording / "results" / "ml.yaml", "camera_to_robot: 7\n");
  const ProcessOutput broken = rigproof_command({"report", recording.string()});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.err, HasSubstr("ml.yaml"));
  ASSERT_EQ(rigproof_command({"calibrate", recording.string(), "-q"}).exit_code, 0);
  const ProcessOutput unknown = rigproof_command({"report", recording.string(), "-m", "mll"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean \"ml\""));
}

TEST(ReportCommand, OfASweepKnowsNeitherOneMethodNorABudget) {
  const TempFolder scratch;
  scratch.write("sweep.yaml", "methods: [ml]\n");
  const std::string folder = scratch.path().string();
  const ProcessOutput method = rigproof_command({"report", folder, "-m", "foo"});
  EXPECT_EQ(method.exit_code, 2);
  EXPECT_THAT(method.err, HasSubstr("--method: the report of a sweep shows all of its methods"));
  const ProcessOutput budget = rigproof_command({"report", folder, "--budget", "ci"});
  EXPECT_EQ(budget.exit_code, 2);
  EXPECT_THAT(budget.err, HasSubstr("--budget: judges one run against its truth"));
}

// A rig that was recorded and calibrated on several days, as observations with dates.
class ReportHistory : public testing::Test {
 protected:
  ReportHistory() {
    const fs::path recording = copy_of_recording(scratch_);
    EXPECT_EQ(rigproof_command({"observe", recording.string(), "-q"}).exit_code, 0);
    EXPECT_EQ(rigproof_command({"calibrate", (recording / "observations.json").string(), "-q"}).exit_code, 0);
    for (const auto& [name, days] : {std::pair("monday", 0), std::pair("tuesday", 1), std::pair("friday", 4)}) {
      nlohmann::json observations = nlohmann::json::parse(read_whole_file(recording / "observations.json"));
      for (nlohmann::json& stop : observations["stops"])
        stop["stamp_s"] = stop["stamp_s"].get<double>() + 1.79e9 + 86400.0 * days;
      fs::create_directories(scratch_ / name / "results");
      write_whole_file(scratch_ / name / "observations.json", observations.dump());
      fs::copy(recording / "results" / "ml.yaml", scratch_ / name / "results" / "ml.yaml");
    }
  }
  ProcessOutput report(const std::vector<std::string>& names, const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments = {"report"};
    for (const std::string& name : names) arguments.push_back((scratch_ / name).string());
    arguments.insert(arguments.end(), options.begin(), options.end());
    return rigproof_command(arguments);
  }
  std::string page(const std::string& name) const { return read_whole_file(scratch_ / name / "history.html"); }

  TempFolder scratch_;
};

TEST_F(ReportHistory, NothingMovedInTheOrderOfTheDays) {
  // On tuesday the only result is one of ml with settings, which is under a name of its own.
  const fs::path tuesday = scratch_ / "tuesday" / "results";
  edit_file(tuesday / "ml.yaml", "method: ml\n", "method: ml-ground_images\n");
  fs::rename(tuesday / "ml.yaml", tuesday / "ml-ground_images.yaml");
  const ProcessOutput output = report({"friday", "monday", "tuesday"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(output.out, HasSubstr((scratch_ / "tuesday" / "history.html").string()));
  EXPECT_THAT(page("tuesday"),
              AllOf(HasSubstr("\"word\":\"STANDS\""), HasSubstr("No camera has shifted in 3 recordings."),
                    HasSubstr("\"title\":\"monday to friday\""), HasSubstr("\"is_dated\":true")));
}

TEST_F(ReportHistory, ACameraThatMovedIsNamedWithTheDaysBetween) {
  // What was calibrated on friday is not asked; the one result that everything is compared with had `left` elsewhere.
  const fs::path first = scratch_ / "monday" / "results" / "ml.yaml";
  const std::string text = read_whole_file(first);
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, std::regex("translation_m: \\[([-0-9.e]+),")));
  std::string moved = text;
  moved.replace(static_cast<std::size_t>(found.position(1)), static_cast<std::size_t>(found.length(1)),
                std::to_string(std::stod(found[1]) + 0.05));
  write_whole_file(first, moved);
  const ProcessOutput output = report({"monday", "tuesday", "friday"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  EXPECT_THAT(page("friday"), AllOf(HasSubstr("\"word\":\"MOVED\""), HasSubstr("left moved between monday"),
                                    HasSubstr(" and tuesday: 5 cm")));
}

TEST_F(ReportHistory, SaysWhatIsWrong) {
  EXPECT_THAT(report({"monday", "tuesday"}, {"-m", "memroc"}).err, HasSubstr("there is no result of memroc"));
  const ProcessOutput budget = report({"monday", "tuesday"}, {"--budget", "ci"});
  EXPECT_EQ(budget.exit_code, 2);
  EXPECT_THAT(budget.err, HasSubstr("--budget: judges one run against its truth"));
  fs::remove_all(scratch_ / "tuesday" / "results");
  const ProcessOutput without = report({"monday", "tuesday"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err,
              AllOf(HasSubstr("tuesday"), HasSubstr("holds no result; make one with: rigproof calibrate")));
  EXPECT_FALSE(fs::exists(scratch_ / "tuesday" / "history.html"));
}

}  // namespace
}  // namespace rigproof
