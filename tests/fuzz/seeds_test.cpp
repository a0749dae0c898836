// What the fuzzer starts from and what it has found: every reader answers or throws Error, whatever it is given.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "paths.h"
#include "readers.h"

namespace rigproof::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> seeds_of(const Reader& reader) {
  std::vector<fs::path> seeds;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::path(source_path("tests/fuzz/seeds")) / reader.name))
    seeds.push_back(entry.path());
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// A seed that is refused at once leads the fuzzer nowhere: each reader has some that it takes, named good*.
TEST(FuzzSeeds, GoodOnesAreTakenAndOthersAreRefusedByError) {
  for (const Reader& reader : readers()) {
    std::size_t good = 0;
    for (const fs::path& seed : seeds_of(reader)) {
      SCOPED_TRACE(seed.string());
      const std::string complaint = complaint_of(reader, content_of(seed));
      if (seed.filename().string().rfind("good", 0) != 0) continue;
      EXPECT_EQ(complaint, "");
      ++good;
    }
    EXPECT_GE(good, 1U) << reader.name;
  }
}

// Where files end early, most readers are wrong: at 64 places each.
TEST(FuzzSeeds, CutOff) {
  for (const Reader& reader : readers()) {
    for (const fs::path& seed : seeds_of(reader)) {
      const std::string content = content_of(seed);
      const std::size_t step = content.size() / 64 + 1;
      for (std::size_t size = 0; size < content.size(); size += step) {
        SCOPED_TRACE(seed.string() + " cut off at " + std::to_string(size));
        complaint_of(reader, content.substr(0, size));
      }
    }
  }
}

}  // namespace
}  // namespace rigproof::fuzz
