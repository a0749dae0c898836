// `rigproof report` as a user types it.
#include <nlohmann/json.hpp>

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

}  // namespace
}  // namespace rigproof
