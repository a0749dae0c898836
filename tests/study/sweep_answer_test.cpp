// Why tasks are not solved, as folders keep it: findings, and sentences in folders of before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "answer.h"
#include "rigproof/words/sentences.h"
#include "sweep_folders.h"
#include "worded.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const std::vector<Finding>& reasons() {
  static const std::vector<Finding> kReasons = {
      Finding("program.failed", {{"text", "ended with signal 11: \xc3\xa9 \"quoted\"\n"}}).of("left"),
      Finding("method.too_few_views")
          .of(std::vector<std::string>{"left", "right"})
          .along({"z"})
          .at({2, 5})
          .with({{"off_mm", 0.1}})};
  return kReasons;
}

SweepAnswer partial_answer() {
  SweepAnswer answer;
  answer.rows.resize(3);
  answer.rows[0].status = answer.rows[1].status = SweepStatus::kPartial;
  answer.rows[0].reasons = answer.rows[1].reasons = reasons();
  answer.rows[1].subject = answer.rows[2].subject = SweepSubject::kCamera;
  answer.rows[2].status = SweepStatus::kSolved;
  return answer;
}

TEST(SweepAnswer, KeepsFindingsAndNoSentence) {
  const std::string text = text_of(partial_answer());
  const std::optional<SweepAnswer> read = read_answer(text);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->rows.size(), 3U);
  EXPECT_EQ(read->rows[0].reasons, reasons());
  EXPECT_EQ(read->rows[1].reasons, reasons());
  EXPECT_TRUE(read->rows[2].reasons.empty()) << "it is solved";
  EXPECT_EQ(code_of(read->rows[0].reasons), "program.failed");
  EXPECT_THAT(text, Not(HasSubstr("there are no two motions")));
}

TEST(SweepAnswer, IsNoneWhereItsFindingsAreDamaged) {
  json object = json::parse(text_of(partial_answer()));
  object["reasons"][0]["code"] = "No code";
  EXPECT_FALSE(read_answer(object.dump()));
  object["reasons"] = 3;
  EXPECT_FALSE(read_answer(object.dump()));
  object.erase("reasons");
  EXPECT_FALSE(read_answer(object.dump()));
}

// As the program before findings wrote it, without a code, and the one after it, with one.
TEST(SweepAnswer, OfBeforeIsReadWithItsSentencesAndItsCode) {
  json object = json::parse(text_of(partial_answer()));
  object["format"] = "rigproof-sweep-answer 1";
  object.erase("reasons");
  for (json& row : object["rows"]) row["reason"] = row["status"] == 0 ? "" : "left: too dark.";
  object["rows"][1]["code"] = "image.dark";
  const std::optional<SweepAnswer> old = read_answer(object.dump());
  ASSERT_TRUE(old);
  EXPECT_EQ(old->rows[0].reasons, std::vector<Finding>{stated("left: too dark.", Severity::kRefusal)});
  EXPECT_EQ(words::text_of(old->rows[1].reasons), "left: too dark.");
  EXPECT_EQ(code_of(old->rows[1].reasons), "image.dark");
  EXPECT_TRUE(old->rows[2].reasons.empty());
  SweepAnswer kept = *old;
  kept.rows[0].reasons = kept.rows[1].reasons;
  const std::optional<SweepAnswer> again = read_answer(text_of(kept));
  ASSERT_TRUE(again);
  EXPECT_EQ(words::text_of(again->rows[0].reasons), "left: too dark.") << "in the new format";
  EXPECT_EQ(code_of(again->rows[0].reasons), "image.dark");
}

void put_words(const std::vector<Finding>& reasons, json* row) {
  const bool is_solved = (*row)["status"] == 0;
  (*row)["reason"] = is_solved ? "" : words::text_of(reasons);
  (*row)["code"] = is_solved ? "" : code_of(reasons);
}

// The same pack with reasons in words, as they were in each row and in the head.
std::string pack_of_before(const std::string& pack) {
  std::istringstream lines(pack);
  std::string line, body;
  std::getline(lines, line);
  json head = json::parse(line);
  head["format"] = "rigproof-sweep-pack 1";
  for (json& entry : head["answers"]) {
    std::getline(lines, line);
    json answer = json::parse(line);
    answer["format"] = "rigproof-sweep-answer 1";
    for (json& row : answer["rows"]) put_words(reasons_of(answer["reasons"]), &row);
    answer.erase("reasons");
    line = answer.dump() + "\n";
    entry[2] = line.size();
    body += line;
  }
  for (json& brief : head["briefs"]) {
    const std::vector<Finding> reasons = reasons_of(brief[1]);
    brief = json::array({brief[0], code_of(reasons), words::text_of(reasons), brief[2]});
  }
  return head.dump() + "\n" + body;
}

class SweepAnswers : public SweepFolders {};

TEST_F(SweepAnswers, PacksOfBeforeMakeTheSameTables) {
  run_sweep(config("mode: geometric\nrun: {poses: 8}\ngeometric: {drive: straight}\nmethods: [ml, li]\n"),
            options("a"));
  const std::string now = tables("a");
  const std::vector<FailureCount> failures = sweep_state(folder_ / "a").failures;
  ASSERT_FALSE(failures.empty());
  ASSERT_NE(code_of(failures[0].reasons), "");
  const fs::path pack = fs::directory_iterator(folder_ / "a" / "packs")->path();
  folder_.write(fs::relative(pack, folder_.path()).string(),
                pack_of_before(folder_.read("a/packs/" + pack.filename().string())));
  gather_sweep(folder_ / "a");
  EXPECT_EQ(tables("a"), now);
  const std::vector<FailureCount> before = sweep_state(folder_ / "a").failures;
  ASSERT_EQ(before.size(), failures.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(code_of(before[i].reasons), code_of(failures[i].reasons));
    EXPECT_EQ(words::text_of(before[i].reasons), words::text_of(failures[i].reasons));
  }
}

}  // namespace
}  // namespace rigproof
