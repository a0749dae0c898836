// The table of docs/reference/limits.md: beyond each bound there is one error, before anything is allocated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "readers.h"
#include "rigproof/core/error.h"
#include "temp_folder.h"

namespace rigproof::fuzz {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const Reader& reader_named(const std::string& name) {
  const auto& all = readers();
  return *std::find_if(all.begin(), all.end(), [&](const Reader& reader) { return reader.name == name; });
}

constexpr std::uintmax_t kMiB = 1U << 20U;

struct FileLimit {
  std::string reader;
  std::uintmax_t bytes;
};

class FileLimits : public testing::TestWithParam<FileLimit> {};

// A file with a hole of that size takes no room on the disk.
TEST_P(FileLimits, OneByteMoreIsRefused) {
  const TempFolder folder;
  const fs::path file = folder.write("file.yaml", "");
  fs::resize_file(file, GetParam().bytes + 1);
  try {
    reader_named(GetParam().reader).read("", file);
    FAIL() << "was read";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("allowed are at most " + std::to_string(GetParam().bytes)));
  }
}

INSTANTIATE_TEST_SUITE_P(AsDocumented, FileLimits,
                         testing::Values(FileLimit{"rig", 4 * kMiB}, FileLimit{"sweep", 4 * kMiB},
                                         FileLimit{"budget", 4 * kMiB}, FileLimit{"result", 16 * kMiB},
                                         FileLimit{"manifest", 128 * kMiB}, FileLimit{"truth", 64 * kMiB},
                                         FileLimit{"odometry", 512 * kMiB}, FileLimit{"trajectory", 512 * kMiB}),
                         [](const auto& tested) { return tested.param.reader; });

std::string nested(const std::string& open, const std::string& close, int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i) text += open;
  text += "1";
  for (int i = 0; i < depth; ++i) text += close;
  return text;
}

TEST(Limits, DepthOfYamlAndJson) {
  EXPECT_THAT(complaint_of(reader_named("rig"), "board: " + nested("[", "]", 40)), HasSubstr("deeper than 32"));
  EXPECT_THAT(complaint_of(reader_named("observations"), nested("{\"a\":", "}", 20)), HasSubstr("deep"));
}

TEST(Limits, AliasesThatMultiply) {
  std::string text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 8; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before;
    for (int k = 0; k < 9; ++k) text += ", " + before;
    text += "]\n";
  }
  EXPECT_THAT(complaint_of(reader_named("rig"), text), HasSubstr("aliases expand"));
}

TEST(Limits, SidesOfPictures) {
  std::string rvl(8, '\0');
  rvl[2] = 1;  // 65536 wide
  rvl[4] = 1;
  EXPECT_THAT(complaint_of(reader_named("rvl"), rvl), HasSubstr("16384"));
  std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\1\0\0\0\0\0\1\x10\0\0\0\0", 29);
  EXPECT_NE(complaint_of(reader_named("depth_image"), png), "");
}

TEST(Limits, PointsOfACloud) {
  EXPECT_NE(complaint_of(reader_named("cloud"),
                         "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 100000000\nHEIGHT 1\n"
                         "POINTS 100000000\nDATA binary\n"),
            "");
}

}  // namespace
}  // namespace rigproof::fuzz
