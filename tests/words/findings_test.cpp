// The table of findings against the sources that make them and the page that explains them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>

#include "paths.h"
#include "rigproof/core/files.h"
#include "rigproof/words/findings_page.h"
#include "worded.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// Codes as sources write them: text of small letters with a point in it that the table knows, or Finding("..").
void add_codes(const std::string& text, const char* pattern, std::set<std::string>* codes) {
  const std::regex code(pattern);
  for (std::sregex_iterator at(text.begin(), text.end(), code), end; at != end; ++at) codes->insert((*at)[1]);
}

std::set<std::string> codes_in_sources(const char* pattern) {
  std::set<std::string> codes;
  for (const char* folder : {"core", "calib", "generator", "validate", "study", "app"})
    for (const auto& entry : fs::recursive_directory_iterator(source_path(folder)))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
        add_codes(read_text_file(entry.path(), 1U << 20U), pattern, &codes);
  return codes;
}

std::set<std::string> codes_of_table() {
  std::set<std::string> codes;
  for (const words::FindingEntry& entry : words::all_findings()) codes.insert(entry.code);
  return codes;
}

TEST(Findings, EveryCodeInTheSourcesIsInTheTable) {
  const std::set<std::string> known = codes_of_table();
  for (const std::string& code : codes_in_sources("Finding\\(\"([^\"]+)\"")) EXPECT_EQ(known.count(code), 1U) << code;
}

TEST(Findings, EveryCodeInTheTableIsMadeSomewhereAndOnce) {
  const std::set<std::string> used = codes_in_sources("\"([a-z_]+(?:\\.[a-z_]+)?)\"");
  for (const std::string& code : codes_of_table()) EXPECT_EQ(used.count(code), 1U) << code;
  EXPECT_EQ(codes_of_table().size(), words::all_findings().size()) << "a code stands twice in the table";
}

TEST(Findings, CausesHaveAPlaceInTheOrderOfPrecedence) {
  std::vector<Finding> findings = {Finding("motion.straight"), Finding("board.size"), Finding("odometry.unit"),
                                   Finding("lens.intrinsics", {{"joined_by", "or"}}), Finding("frames.swapped")};
  causes_first(&findings);
  std::vector<std::string> codes;
  for (const Finding& finding : findings) codes.push_back(finding.code);
  EXPECT_THAT(codes, testing::ElementsAre("frames.swapped", "odometry.unit", "lens.intrinsics", "board.size",
                                          "motion.straight"));
}

TEST(Findings, ACodeThatTheTableLacksIsAFaultOfTheProgram) { EXPECT_THROW(Finding("no.such_code"), std::logic_error); }

TEST(Findings, EveryOneHasWordsAndSaysWhatToDo) {
  for (const words::FindingEntry& entry : words::all_findings()) {
    EXPECT_FALSE(entry.words.empty()) << entry.code;
    EXPECT_FALSE(entry.remedy.empty()) << entry.code;
    EXPECT_FALSE(worded(Finding(entry.code)).empty()) << entry.code;
  }
}

TEST(Findings, ThePageIsMadeOfTheTable) {
  const std::string page = source_path("docs/reference/findings.md");
  if (std::getenv("RIGPROOF_UPDATE_DOCS") != nullptr) write_file_atomically(page, words::findings_page());
  EXPECT_EQ(read_text_file(page, 1U << 20U), words::findings_page()) << "RIGPROOF_UPDATE_DOCS=1 test_words writes it";
}

}  // namespace
}  // namespace rigproof
