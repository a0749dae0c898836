// Files that are cut off, damaged or made to hurt: every reader throws Error or answers, and never crashes.
#include <gtest/gtest.h>

#include <functional>

#include "error_text.h"
#include "memroc_sample.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/odometry_csv.h"
#include "rigproof/formats/format.h"
#include "sample_data.h"
#include "sample_truth.h"

namespace rigproof {
namespace {

struct Reader {
  std::string name;
  std::string content;
  /// Reads the file; may throw Error only.
  std::function<void(const std::filesystem::path&)> read;
};

std::string saved(const std::function<void(const std::filesystem::path&)>& save) {
  const TempFolder folder;
  save(folder / "file");
  return folder.read("file");
}

std::vector<Reader> all_readers() {
  const Recording recording = sample_recording("");
  return {
      {"rig.yaml", saved([](const auto& f) { save_rig(sample_rig(), f); }), [](const auto& f) { load_rig(f); }},
      {"observations.json", saved([](const auto& f) { save_observations(sample_observations(), f); }),
       [](const auto& f) { load_observations(f); }},
      {"result.yaml", saved([](const auto& f) { save_result(sample_result(), f); }),
       [](const auto& f) { load_result(f); }},
      {"truth.yaml", saved([](const auto& f) { save_truth(sample_truth(), f); }), [](const auto& f) { load_truth(f); }},
      {"run.yaml", saved([](const auto& f) { save_manifest(sample_manifest(), f); }),
       [](const auto& f) { load_manifest(f); }},
      {"odometry.csv", odometry_csv(recording.odometry), [](const auto& f) {
         Problems problems;
         read_odometry_csv(f, &problems);
         problems.throw_if_any();
       }}};
}

// Error is the one way out besides an answer; gtest reports any other exception, a crash ends the program.
bool throws_error(const Reader& reader, const std::filesystem::path& file) {
  try {
    reader.read(file);
    return false;
  } catch (const Error& error) {
    EXPECT_GT(std::string(error.what()).size(), 10U);
    return true;
  }
}

TEST(HostileInput, FilesCutOffAtEveryByte) {
  const TempFolder folder;
  for (const Reader& reader : all_readers()) {
    std::size_t refused = 0;
    for (std::size_t size = 0; size < reader.content.size(); ++size) {
      const auto file = folder.write(reader.name, reader.content.substr(0, size));
      if (throws_error(reader, file)) ++refused;
    }
    // YAML and CSV cut between lines may still be whole; what is missing at the end is then optional.
    EXPECT_GT(refused, reader.content.size() / 20) << reader.name;
    if (reader.name == "observations.json") {
      EXPECT_GE(refused, reader.content.size() - 2) << "only white space is free";
    }
  }
}

std::string mutated(std::string text, RandomStream& random) {
  static const std::vector<std::string> kPieces = {"nan",    ".inf", "1e308", "-1",   "99999999999999999999",
                                                   "[",      "]",    "{",     "}",    ":",
                                                   "\n",     "- ",   "&a ",   "*a",   "\"",
                                                   "'",      "\\",   "null",  "~",    "? ",
                                                   "!!int ", "%",    "\xff",  "\xc3", ",",
                                                   "#",      "\t",   "|",     ">",    "../..",
                                                   "/",      "0",    "true",  "",     "  ",
                                                   "---"};
  for (std::uint32_t i = 1 + random.below(3); i > 0; --i) {
    const std::size_t at = random.below(static_cast<std::uint32_t>(text.size() + 1));
    const std::size_t length = std::min<std::size_t>(random.below(6), text.size() - at);
    switch (random.below(4)) {
      case 0:
        text.replace(at, length, kPieces[random.below(static_cast<std::uint32_t>(kPieces.size()))]);
        break;
      case 1:
        text.erase(at, length * 20);
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(random.below(256));
        break;
      default:
        text.insert(at, text.substr(at / 2, length * 10));
    }
  }
  return text;
}

TEST(HostileInput, ThousandsOfDamagedFiles) {
  const TempFolder folder;
  for (const Reader& reader : all_readers()) {
    RandomStream random(1, reader.name);
    for (int i = 0; i < 700; ++i) {
      SCOPED_TRACE(reader.name + " " + std::to_string(i));
      throws_error(reader, folder.write(reader.name, mutated(reader.content, random)));
    }
  }
}

TEST(HostileInput, DamagedMemrocFolders) {
  RandomStream random(2, "memroc");
  const MemrocFolder folder;
  for (const char* name : {"CalibrationInfo.yaml", "camera1/intrinsic_pars_file.yaml", "camera1/pose/0000.csv"}) {
    const std::string content = folder.read(name);
    for (int i = 0; i < 200; ++i) {
      folder.write(name, mutated(content, random));
      try {
        open_input(folder.path());
      } catch (const Error&) {
      }
    }
    folder.write(name, content);
  }
  EXPECT_NO_THROW(open_input(folder.path()));
}

TEST(HostileInput, LargeCountsAreRefusedBeforeTheyAreAllocated) {
  const TempFolder folder;
  folder.write("rig.yaml", "board: {squares: [2000000000, 2000000001], square_mm: 1}\ncameras: {}\n");
  EXPECT_NE(error_text([&] { load_rig(folder / "rig.yaml"); }), "");
  std::string cameras = "board: {squares: [6, 5], square_mm: 1}\ncameras:\n";
  for (int i = 0; i < 20000; ++i) cameras += "  c" + std::to_string(i) + ": {}\n";
  folder.write("rig.yaml", cameras);
  EXPECT_NE(error_text([&] { load_rig(folder / "rig.yaml"); }), "");
}

}  // namespace
}  // namespace rigproof
