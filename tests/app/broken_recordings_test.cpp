// Recordings with one thing wrong each, from the files on: what contradicts must reach the estimator, and be named.
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <regex>
#include <sstream>

#include "cli_fixture.h"
#include "rigproof/core/observations.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;

// Adds to and scales columns of a CSV file with a head.
struct Column {
  std::size_t index;
  double factor, offset;
};
void edit_columns(const fs::path& file, const std::vector<Column>& columns) {
  std::istringstream lines(read_whole_file(file));
  std::string line, text;
  for (int row = 0; std::getline(lines, line); ++row) {
    std::istringstream cells(line);
    std::string cell, edited;
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      for (const Column& column : columns)
        if (row > 0 && column.index == i) cell = nlohmann::json(column.factor * std::stod(cell) + column.offset).dump();
      edited += (i > 0 ? "," : "") + cell;
    }
    text += edited + "\n";
  }
  write_whole_file(file, text);
}

// Every number behind a key of rig.yaml, scaled and moved.
void edit_rig(const fs::path& recording, const std::string& key, double factor, double offset) {
  const std::string text = read_whole_file(recording / "rig.yaml");
  const std::regex value("\\b(" + key + "): ([0-9.]+)");
  std::string edited;
  auto from = text.cbegin();
  for (std::sregex_iterator it(text.begin(), text.end(), value), end; it != end; ++it) {
    edited.append(from, (*it)[0].first);
    edited += (*it)[1].str() + ": " + nlohmann::json(factor * std::stod((*it)[2]) + offset).dump();
    from = (*it)[0].second;
  }
  edited.append(from, text.cend());
  ASSERT_NE(edited, text) << key;
  write_whole_file(recording / "rig.yaml", edited);
}

void shift_stamps(const fs::path& recording, double seconds) {
  for (const char* camera : {"left", "center", "right"})
    edit_columns(recording / camera / "frames.csv", {{1, 1.0, seconds}});
}

struct Broken {
  const char* name;
  const char* cause;
  void (*apply)(const fs::path& recording);
};
void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.name; }

const Broken kBroken[] = {
    {"DepthUnit", "depth is in another unit", [](const fs::path& r) { edit_rig(r, "unit_m", 0.5, 0.0); }},
    {"DepthScale", "board's size", [](const fs::path& r) { edit_rig(r, "unit_m", 1.1, 0.0); }},
    {"BoardTooLarge", "board's size", [](const fs::path& r) { edit_rig(r, "square_mm", 1.1, 0.0); }},
    {"BoardTooSmall", "board's size", [](const fs::path& r) { edit_rig(r, "square_mm", 0.94, 0.0); }},
    {"FocalLengths", "intrinsics of all cameras", [](const fs::path& r) { edit_rig(r, "f[xy]_px", 1.1, 0.0); }},
    {"HalfAPixel", "half-pixel offset between the corners and the intrinsics of all cameras",
     [](const fs::path& r) { edit_rig(r, "c[xy]_px", 1.0, 0.5); }},
    {"PrincipalPoints", "principal point of all cameras", [](const fs::path& r) { edit_rig(r, "c[xy]_px", 1.0, 6.0); }},
    {"Mirrored", "odometry is mirrored",
     [](const fs::path& r) {
       edit_columns(r / "odometry.csv", {{2, -1.0, 0.0}, {3, -1.0, 0.0}});
     }},
    {"YawSign", "odometry's yaw has the wrong sign",
     [](const fs::path& r) {
       edit_columns(r / "odometry.csv", {{3, -1.0, 0.0}});
     }},
    {"Millimetres", "odometry's positions are in millimetres",
     [](const fs::path& r) {
       edit_columns(r / "odometry.csv", {{1, 1e3, 0.0}, {2, 1e3, 0.0}});
     }},
    {"StampsAhead", "odometry's stamps are shifted: its rows run ahead of the images by about 1 stop",
     [](const fs::path& r) { shift_stamps(r, 2.0); }},
    {"StampsBehind", "odometry's stamps are shifted: its rows run behind the images by about 1 stop",
     [](const fs::path& r) { shift_stamps(r, -2.0); }},
};

class BrokenRecordings : public testing::TestWithParam<Broken> {};

TEST_P(BrokenRecordings, AreRefusedAndTheCauseIsNamed) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  GetParam().apply(recording);
  const ProcessOutput output = rigproof_command({"calibrate", recording.string()});
  EXPECT_EQ(output.exit_code, 3) << output.out << output.err;
  EXPECT_THAT(output.out, ContainsRegex(std::string("REFUSED  Most likely cause: (a|the) ") + GetParam().cause));
}

INSTANTIATE_TEST_SUITE_P(Every, BrokenRecordings, testing::ValuesIn(kBroken),
                         [](const testing::TestParamInfo<Broken>& broken) { return std::string(broken.param.name); });

// Something before the board in one frame is no wrong scale of all.
TEST(BrokenRecording, OneOddDepthImageIsLeftOut) {
  const TempFolder scratch;
  const fs::path recording = copy_of_recording(scratch);
  const std::string file = (recording / "left/depth/000003.png").string();
  cv::Mat depth = cv::imread(file, cv::IMREAD_UNCHANGED);
  ASSERT_FALSE(depth.empty());
  depth *= 1.3;
  ASSERT_TRUE(cv::imwrite(file, depth));
  const std::string found = (scratch / "found.json").string();
  ASSERT_EQ(rigproof_command({"observe", recording.string(), "-o", found, "-q"}).exit_code, 0);
  const Observations observations = load_observations(found);
  const auto is_odd = [](const PlaneObservation& plane) { return plane.camera == 0 && plane.stop == 3; };
  for (const auto* planes : {&observations.board_planes, &observations.ground_planes}) {
    EXPECT_TRUE(std::none_of(planes->begin(), planes->end(), is_odd));
    EXPECT_GE(planes->size(), 27U);
  }
  EXPECT_EQ(rigproof_command({"calibrate", recording.string(), "-q"}).exit_code, 0);
}

}  // namespace
}  // namespace rigproof
