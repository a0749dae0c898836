#include "rigproof/generator/generator_version.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "paths.h"
#include "process.h"
#include "rigproof/core/files.h"
#include "rigproof/core/version.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

TEST(GeneratorVersion, IsTheVersionAndAHash) {
  EXPECT_THAT(generator_version(), testing::StartsWith(std::string(version()) + "+"));
  EXPECT_THAT(generator_version().substr(std::string(version()).size() + 1), testing::MatchesRegex("[0-9a-f]{12}"));
}

// As the build does it.
std::string hash_of(const TempFolder& root) {
  const fs::path header = root / "hash.h";
  const ProcessOutput run = run_process({"cmake", "-DROOT=" + root.path().string(), "-DOUTPUT=" + header.string(), "-P",
                                         source_path("cmake/HashOfSources.cmake")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return read_text_file(header);
}

TEST(GeneratorVersion, GoesByTheSourcesThatMakeData) {
  const TempFolder root;
  const auto write = [&root](const char* file, const char* text) {
    fs::create_directories((root / file).parent_path());
    write_file_atomically(root / file, std::string_view(text));
  };
  write("core/src/a.cpp", "int a;");
  write("generator/include/b.h", "int b;");
  write("calib/src/c.cpp", "int c;");
  const std::string hash = hash_of(root);
  EXPECT_THAT(hash, testing::MatchesRegex("#define RIGPROOF_GENERATOR_SOURCES \"[0-9a-f]{12}\"\n"));
  write("calib/src/c.cpp", "int changed;");
  EXPECT_EQ(hash_of(root), hash);
  write("generator/include/b.h", "int changed;");
  const std::string other = hash_of(root);
  EXPECT_NE(other, hash);
  fs::rename(root / "core/src/a.cpp", root / "core/src/renamed.cpp");
  EXPECT_NE(hash_of(root), other);
  write("sim/src/a.cpp", "int a;");
  fs::rename(root / "core/src/renamed.cpp", root / "core/src/a.cpp");
  EXPECT_NE(hash_of(root), other);
}

}  // namespace
}  // namespace rigproof
