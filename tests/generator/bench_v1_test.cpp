// bench-v1 is frozen: its configurations, and the world, robot, rig and sensors that they name.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>

#include "paths.h"
#include "rigproof/core/files.h"
#include "rigproof/generator/config.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = source_path();
const fs::path kBench = kSource / "config/bench-v1";

// Name and pinned sum of every configuration.
std::map<std::string, std::string> pinned_sums() {
  std::map<std::string, std::string> sums;
  std::istringstream lines(read_text_file(kBench / "SHA256SUMS"));
  for (std::string sum, name; lines >> sum >> name;) sums[name] = sum;
  return sums;
}

TEST(BenchV1, ConfigurationsAreThoseThatWerePublished) {
  const std::map<std::string, std::string> sums = pinned_sums();
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(kBench)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".yaml") continue;
    ++files;
    ASSERT_EQ(sums.count(name), 1U) << name << " is not in SHA256SUMS";
    EXPECT_EQ(sha256_hex_of_file(entry.path()), sums.at(name)) << name << ": bench-v1 is frozen, make bench-v2";
  }
  EXPECT_EQ(files, sums.size());
  EXPECT_EQ(files, 16U);
}

TEST(BenchV1, WorldsRobotsRigsAndSensorsAreThoseThatWerePublished) {
  std::size_t inputs = 0;
  for (const auto& entry : fs::directory_iterator(kBench)) {
    if (entry.path().extension() != ".yaml") continue;
    std::istringstream lines(read_text_file(entry.path()));
    for (std::string line; std::getline(lines, line) && line.rfind("#", 0) == 0;) {
      std::istringstream words(line);
      std::string mark, kind, sum, path;
      if (!(words >> mark >> kind >> sum >> path) || kind != "input") continue;
      ++inputs;
      EXPECT_EQ(sha256_hex_of_file(kSource / path), sum)
          << path << " has changed under " << entry.path().filename() << ": see README.md there";
    }
  }
  EXPECT_GE(inputs, 15U * 4U);
}

// A field that a case leaves out would follow the program's default.
TEST(BenchV1, CasesReadBackAndNameEveryFieldOfTheirTime) {
  for (const auto& [name, sum] : pinned_sums()) {
    if (name == "bench-v1.yaml") continue;
    const GenerateConfig config = load_generate_config(kBench / name);
    EXPECT_EQ(config.seed, 1) << name;
    EXPECT_EQ(config.image_scale, 1.0) << name;
    EXPECT_EQ(config.name, fs::path(name).stem().string());
    const std::string text = read_text_file(kBench / name);
    for (const char* field : {"\nposes:", "\nodometry:", "\nsensing:", "\nrender:", "\npng_level:"})
      EXPECT_NE(text.find(field), std::string::npos) << name << field;
  }
}

}  // namespace
}  // namespace rigproof
