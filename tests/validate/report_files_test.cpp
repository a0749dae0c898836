#include "rigproof/validate/report_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "rigproof/core/files.h"
#include "rigproof/words/sentences.h"
#include "synthetic.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using namespace testing_support;
using boost::property_tree::ptree;

Budget some_budget() {
  Budget budget;
  budget.name = "ci.yaml";
  budget.camera_to_robot = Vector6d::Constant(0.002);
  budget.max_z = 4.0;
  return budget;
}

ValidationRecord record_of(const Truth& truth, const Result& result, const std::string& subject) {
  ValidationRecord record;
  record.subject = subject;
  record.budget = some_budget();
  record.comparison = compare(result, truth);
  record.gate = apply_budget(record.comparison, record.budget);
  return record;
}

Result failing_result(const Truth& truth) {
  Vector6d error = Vector6d::Zero();
  error[2] = 0.01;
  Result result = make_result(truth, {Vector6d::Zero(), error, Vector6d::Zero()});
  result.camera_to_robot[0].covariance = Matrix6d(1e-6 * Matrix6d::Identity());
  return result;
}

ptree parsed(const std::string& xml) {
  std::istringstream stream(xml);
  ptree tree;
  boost::property_tree::read_xml(stream, tree);
  return tree;
}

TEST(JUnit, OneCaseACheckAndFailuresWithMessages) {
  const Truth truth = make_truth();
  const ValidationRecord record = record_of(truth, failing_result(truth), "theirs.yaml");
  const ptree tree = parsed(to_junit({record, record_of(truth, exact_result(truth), "ml")}));
  const ptree& suites = tree.get_child("testsuites");
  EXPECT_EQ(suites.get<int>("<xmlattr>.failures"), 1);
  const ptree& suite = suites.get_child("testsuite");
  EXPECT_EQ(suite.get<std::string>("<xmlattr>.name"), "theirs.yaml");
  EXPECT_EQ(suite.count("testcase"), record.gate.checks.size());
  EXPECT_EQ(suite.get<std::size_t>("<xmlattr>.tests"), record.gate.checks.size());
  std::vector<std::string> failures;
  for (const auto& [name, child] : suite)
    if (name == "testcase" && child.count("failure") > 0)
      failures.push_back(child.get<std::string>("<xmlattr>.name") + " | " +
                         child.get<std::string>("failure.<xmlattr>.message"));
  EXPECT_THAT(failures, testing::ElementsAre("center in robot: tz | 1 cm, allowed 0.2 cm"));
}

TEST(JUnit, HostileNamesAreEscaped) {
  Truth truth = make_truth();
  const std::string nasty = "a<b>&\"c'\x01\xff\xed\xa0\x80 d\n]]>";
  truth.cameras[1].name = nasty;
  Result result = failing_result(truth);
  result.method = nasty;
  const ptree tree = parsed(to_junit({record_of(truth, result, nasty)}));
  // Bytes that XML cannot hold (a control character, no UTF-8, a surrogate) become question marks.
  EXPECT_EQ(tree.get<std::string>("testsuites.testsuite.<xmlattr>.name"), "a<b>&\"c'????? d\n]]>");
}

TEST(JUnit, KeepsProperUtf8) {
  const Truth truth = make_truth();
  const std::string name = "mit Größe \xe2\x82\xac \xf0\x9f\x93\xb7";
  const ptree tree = parsed(to_junit({record_of(truth, failing_result(truth), name)}));
  EXPECT_EQ(tree.get<std::string>("testsuites.testsuite.<xmlattr>.name"), name);
}

TEST(JUnit, NothingCheckedIsAFailure) {
  const Truth truth = make_truth();
  ValidationRecord record = record_of(truth, exact_result(truth), "theirs.yaml");
  record.budget = default_budget();
  record.gate = apply_budget(record.comparison, record.budget);
  const ptree tree = parsed(to_junit({record}));
  EXPECT_EQ(tree.get<int>("testsuites.<xmlattr>.failures"), 1);
  EXPECT_EQ(tree.get<int>("testsuites.testsuite.<xmlattr>.tests"), 1);
}

TEST(JUnit, AFileThatCannotBeJudgedIsAnError) {
  const Truth truth = make_truth();
  ValidationRecord unreadable;
  unreadable.subject = "missing.yaml";
  unreadable.unreadable = "missing.yaml: cannot be read";
  const ptree tree = parsed(to_junit({record_of(truth, exact_result(truth), "ml"), unreadable}));
  const ptree& suites = tree.get_child("testsuites");
  EXPECT_EQ(suites.get<int>("<xmlattr>.errors"), 1);
  EXPECT_EQ(suites.get<int>("<xmlattr>.failures"), 0);
  const ptree& suite = suites.back().second;
  EXPECT_EQ(suite.get<std::string>("<xmlattr>.name"), "missing.yaml");
  EXPECT_EQ(suite.get<int>("<xmlattr>.tests"), 1);
  EXPECT_EQ(suite.get<int>("<xmlattr>.errors"), 1);
  EXPECT_EQ(suite.get<std::string>("testcase.error.<xmlattr>.message"), "missing.yaml: cannot be read");
}

// The `type` of every failure, and the codes of notes.
TEST(JUnit, CarriesStableCodes) {
  const Truth truth = make_truth();
  Result result = failing_result(truth);
  result.notes.push_back(Finding("prior.strained").of("left"));
  ValidationRecord record = record_of(truth, result, "theirs.yaml");
  add_suspicions(result.notes, &record.gate);
  const ptree suite = parsed(to_junit({record})).get_child("testsuites.testsuite");
  std::vector<std::string> types, note_codes;
  for (const auto& [name, child] : suite)
    if (const auto type = child.get_optional<std::string>("failure.<xmlattr>.type")) types.push_back(*type);
  EXPECT_THAT(types, testing::ElementsAre("budget", "prior.strained"));
  for (const auto& [name, child] : suite.get_child("properties"))
    if (child.get<std::string>("<xmlattr>.name") == "note_code")
      note_codes.push_back(child.get<std::string>("<xmlattr>.value"));
  EXPECT_THAT(note_codes, testing::Each("gate.no_sigma"));
  EXPECT_EQ(note_codes.size(), record.gate.notes.size());
  EXPECT_FALSE(note_codes.empty());
  EXPECT_NE(
      to_junit({record_of(truth, failing_result(truth), "ml")}).find("name=\"cause_code\" value=\"errors.one_axis\""),
      std::string::npos);
}

TEST(JsonReport, HoldsErrorsExactly) {
  const Truth truth = make_truth();
  const ValidationRecord record = record_of(truth, failing_result(truth), "theirs.yaml");
  const auto json = nlohmann::json::parse(to_json({record}, words::sentence_of));
  EXPECT_FALSE(json["passed"].get<bool>());
  const auto& result = json["results"][0];
  EXPECT_EQ(result["subject"], "theirs.yaml");
  EXPECT_EQ(result["camera_to_robot"].size(), 3U);
  for (std::size_t axis = 0; axis < 6; ++axis)
    EXPECT_EQ(result["camera_to_robot"][1]["error_m_rad"][axis].get<double>(),
              record.comparison.camera_to_robot[1].error[static_cast<Eigen::Index>(axis)]);
  EXPECT_TRUE(result["camera_to_robot"][1]["sigma_m_rad"].is_null());
  EXPECT_EQ(result["camera_to_robot"][0]["sigma_m_rad"][0].get<double>(), 1e-3);
  EXPECT_EQ(result["explanation"], "center is 1.0 cm too high");
  EXPECT_EQ(result["causes"][0]["sentence"], result["explanation"]);
  EXPECT_EQ(result["causes"][0]["code"], "errors.one_axis");
  EXPECT_EQ(result["causes"][0]["cameras"][0], "center");
  EXPECT_NEAR(result["causes"][0]["values"]["z_cm"].get<double>(), 1.0, 1e-9);
  EXPECT_TRUE(result["convention_suspicion"].is_null());
  EXPECT_EQ(result["checks"].size(), record.gate.checks.size());
  EXPECT_TRUE(result["nees"]["all"].is_null());
}

TEST(JsonReport, NamesAWrongConvention) {
  const Truth truth = make_truth();
  Result result = exact_result(truth);
  for (EstimatedTransform& estimate : result.camera_to_robot)
    estimate.T_parent_child = estimate.T_parent_child.inverse();
  const ValidationRecord record = record_of(truth, result, "theirs.yaml");
  const auto suspicion = nlohmann::json::parse(to_json({record}))["results"][0]["convention_suspicion"];
  EXPECT_EQ(suspicion["conventions"][0]["code"], "convention.inverted");
  EXPECT_EQ(suspicion["explanation"], "convention.inverted") << "nobody words it";
  EXPECT_GT(suspicion["error_rad"].get<double>(), 1.0);
  EXPECT_NE(to_junit({record}).find("<property name=\"convention_code\" value=\"convention.inverted\"/>"),
            std::string::npos);
}

TEST(JsonReport, BadBytesDoNotThrow) {
  const Truth truth = make_truth();
  const auto json = nlohmann::json::parse(to_json({record_of(truth, exact_result(truth), "bad \xff byte")}));
  EXPECT_EQ(json["results"][0]["subject"], "bad \xef\xbf\xbd byte");  // U+FFFD
}

TEST(JUnit, IsWrittenWhole) {
  const TempFolder folder;
  const Truth truth = make_truth();
  const std::vector<ValidationRecord> records = {record_of(truth, exact_result(truth), "ml")};
  save_junit(records, folder / "out" / "junit.xml");
  EXPECT_EQ(read_text_file(folder / "out" / "junit.xml"), to_junit(records));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "out"), {}), 1);
}

}  // namespace
}  // namespace rigproof
