// config/bench-v1/score.py, which needs nothing but Python, says what validate says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "paths.h"
#include "process.h"
#include "random_values.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/validate/budget.h"
#include "rigproof/validate/report_files.h"
#include "synthetic.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using namespace testing_support;
using nlohmann::json;
using testing::HasSubstr;

constexpr int kResults = 200;

/// Results of all kinds: of any size of error, with and without covariances, partial, reversed, incomplete.
class RandomResult {
 public:
  RandomResult(const Truth& truth, std::int64_t index) : truth_(truth), random_(3, "score", index) {}

  Result make() {
    result_.method = "random";
    std::vector<int> order = {0, 1, 2};
    for (const int k : order)
      if (!chance(0.1)) add_camera(k);
    if (chance(0.5)) add_pairs();
    const bool whole = std::all_of(result_.camera_to_robot.begin(), result_.camera_to_robot.end(),
                                   [](const EstimatedTransform& t) { return t.fully_observable(); });
    if (whole && !result_.camera_to_robot.empty() && chance(0.5)) add_joint();
    result_.status = chance(0.8) ? ResultStatus::kSolved : ResultStatus::kPartial;
    if (chance(0.2)) result_.notes.push_back(Finding("prior.strained").of("left"));
    return result_;
  }

 private:
  bool chance(double share) { return random_.uniform() < share; }

  Vector6d error() {
    Vector6d error;
    const double size = std::pow(10.0, random_.uniform(-4.5, -0.5));
    for (Eigen::Index i = 0; i < 6; ++i) error[i] = random_.normal(0.0, size);
    return error;
  }

  std::optional<Matrix6d> covariance(const Vector6d& error) {
    if (chance(0.3)) return std::nullopt;
    const Vector6d sigmas = Vector6d::Constant(error.cwiseAbs().maxCoeff() * random_.uniform(0.2, 3.0));
    return Matrix6d(random_covariance(sigmas, random_));
  }

  EstimatedTransform estimate(const std::string& parent, const std::string& child, const Rigid3& T_true) {
    const Vector6d e = error();
    EstimatedTransform estimate{parent, child, apply_transform_error(T_true, e), covariance(e)};
    if (!chance(0.25)) return estimate;
    estimate.T_parent_child = estimate.T_parent_child.inverse();  // the covariance is whatever it is
    std::swap(estimate.parent, estimate.child);
    return estimate;
  }

  void add_camera(int k) {
    const TrueCamera& camera = truth_.cameras[static_cast<std::size_t>(k)];
    EstimatedTransform camera_in_robot = estimate("base", camera.name, camera.T_robot_camera);
    if (camera_in_robot.parent == "base" && chance(0.4))
      for (bool& observable : camera_in_robot.observable) observable = chance(0.7);
    result_.camera_to_robot.push_back(camera_in_robot);
  }

  void add_pairs() {
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = j + 1; k < 3; ++k)
        if (chance(0.6))
          result_.camera_to_camera.push_back(
              estimate(truth_.cameras[j].name, truth_.cameras[k].name,
                       truth_.cameras[j].T_robot_camera.inverse() * truth_.cameras[k].T_robot_camera));
  }

  void add_joint() {
    const auto size = static_cast<Eigen::Index>(6 * result_.camera_to_robot.size());
    result_.joint_covariance = random_covariance(Eigen::VectorXd::Constant(size, random_.uniform(1e-4, 0.1)), random_);
  }

  const Truth& truth_;
  RandomStream random_;
  Result result_;
};

// As other people write YAML: a comment, quotes, lists over several lines.
std::string foreign_text(const Result& result, RandomStream random) {
  std::ostringstream text;
  text.precision(17);
  // By the names of the children, which are those of cameras unless a pose is told the other way round.
  const bool as_map =
      random.uniform() < 0.5 && std::all_of(result.camera_to_robot.begin(), result.camera_to_robot.end(),
                                            [](const auto& pose) { return pose.parent == "base"; });
  text << "# poses  # of mine\nmethod: 'it''s mine'\ntransforms:" << (as_map ? "\n" : "   # a list\n");
  for (const EstimatedTransform& estimate : result.camera_to_robot) {
    const Eigen::Vector3d& t = estimate.T_parent_child.translation;
    const Eigen::Vector4d q = estimate.T_parent_child.rotation.coeffs() * random.uniform(0.9995, 1.0005);
    const std::string indent = as_map ? "    " : "  ";
    if (as_map)
      text << "  \"" << estimate.child << "\":\n" << indent;
    else
      text << "- child: " << estimate.child << "\n" << indent;
    text << "parent: \"" << estimate.parent << "\"\n\n"
         << indent << "translation_m:\n"
         << indent << "- " << t.x() << "\n"
         << indent << "-   " << t.y() << "\n"
         << indent << "- " << t.z() << "  # up\n"
         << indent << "quaternion_xyzw: [" << q.x() << ",\n"
         << indent << "   " << q.y() << ", " << q.z() << ", " << q.w() << "]\n";
    if (random.uniform() < 0.5)
      text << indent << "stddev: {tx_cm: 1, ty_cm: .5, tz_cm: 2e-1, rx_deg: 0.1, ry_deg: 0.1, rz_deg: 1}\n";
  }
  return text.str();
}

std::string limits_text(RandomStream& random) {
  const auto limit = [&random] { return number_text(std::pow(10.0, random.uniform(-1.0, 1.3))); };
  std::string text;
  if (random.uniform() < 0.7)
    text += "camera_to_robot: {tx_cm: " + limit() + ", distance_cm: " + limit() + ", angle_deg: " + limit() + "}\n";
  if (random.uniform() < 0.5) text += "camera_to_camera:\n  rz_deg: " + limit() + "  # alone\n";
  if (text.empty() || random.uniform() < 0.5) text += "max_z: " + number_text(random.uniform(0.5, 5.0)) + "\n";
  return text;
}

void expect_same(const json& ours, const json& theirs, const std::string& where) {
  if (theirs.is_object()) {
    for (const auto& [key, value] : theirs.items()) expect_same(ours.at(key), value, where + "." + key);
  } else if (theirs.is_array()) {
    ASSERT_EQ(ours.size(), theirs.size()) << where;
    for (std::size_t i = 0; i < theirs.size(); ++i)
      expect_same(ours[i], theirs[i], where + "[" + std::to_string(i) + "]");
  } else if (theirs.is_number()) {
    ASSERT_TRUE(ours.is_number()) << where << ours;
    const double a = ours.get<double>(), b = theirs.get<double>();
    EXPECT_NEAR(a, b, 1e-6 * std::max(std::abs(a), 1e-6)) << where;
  } else {
    EXPECT_EQ(ours, theirs) << where;
  }
}

class Score : public testing::Test {
 protected:
  Score() : truth_(make_truth()) { save_truth(truth_, folder_ / "truth.yaml"); }

  ProcessOutput score(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"python3", source_path("config/bench-v1/score.py")});
    return run_process(arguments);
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  TempFolder folder_;
  Truth truth_;
};

TEST_F(Score, AgreesWithValidateOnAnyResult) {
  int passed = 0, failed = 0;
  for (int budget_index = 0; budget_index < 5; ++budget_index) {
    RandomStream random(4, "budget", budget_index);
    std::vector<std::string> arguments = {file("truth.yaml"), "--json"};
    Budget budget = default_budget();
    if (budget_index > 0) {
      const std::string name = "budget" + std::to_string(budget_index) + ".yaml";
      folder_.write(name, limits_text(random));
      budget = load_budget(folder_ / name);
      arguments.insert(arguments.end(), {"--budget", file(name)});
    }
    std::vector<ValidationRecord> records;
    for (int i = 0; i < kResults / 5; ++i) {
      const int index = 1000 * budget_index + i;
      const Result result = RandomResult(truth_, index).make();
      const std::string name = std::to_string(index) + ".yaml";
      if (i % 5 == 4 && !result.camera_to_robot.empty())
        folder_.write(name, foreign_text(result, RandomStream(5, "foreign", index)));
      else
        save_result(result, folder_ / name, {});
      const Comparison comparison = compare(load_result(folder_ / name), truth_);
      records.push_back({name, comparison, budget, apply_budget(comparison, budget)});
      if (budget.nothing_suspected) add_suspicions(load_result(folder_ / name).notes, &records.back().gate);
      arguments.push_back(file(name));
      ++(records.back().gate.passed() ? passed : failed);
    }
    const ProcessOutput output = score(arguments);
    ASSERT_LE(output.exit_code, 1) << output.err;
    const json ours = json::parse(to_json(records)), theirs = json::parse(output.out);
    EXPECT_EQ(output.exit_code, ours["passed"] ? 0 : 1);
    expect_same(ours, theirs, "");
  }
  // A comparison of verdicts that are all alike would show little.
  EXPECT_GT(passed, kResults / 20);
  EXPECT_GT(failed, kResults / 4);
}

TEST_F(Score, ReadsMcCalibsFileAsValidateDoes) {
  std::string lenses = "%YAML:1.0\n---\nnb_camera: 3\n", answer = lenses;
  const Rigid3 T_first_robot = truth_.cameras[0].T_robot_camera.inverse();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string key = "camera_" + std::to_string(k) + ":\n";
    lenses += key + "   name: \"" + truth_.cameras[k].name + "\"\n";
    Vector6d error = Vector6d::Zero();
    if (k > 0) error << 0.01, -0.002, 0.003, 0.001, 0.002, -0.001;
    const Eigen::Matrix4d T = apply_transform_error(T_first_robot * truth_.cameras[k].T_robot_camera, error).matrix();
    answer += key + "   camera_group: 0\n   camera_pose_matrix: !!opencv-matrix\n      rows: 4\n      data: [";
    for (int i = 0; i < 16; ++i)
      answer += (i == 0 ? "" : i % 4 == 0 ? ",\n         " : ", ") + number_text(T(i / 4, i % 4));
    answer += "]\n";
  }
  folder_.write("camera_params.yml", lenses);
  folder_.write("calibrated_cameras_data.yml", answer);
  folder_.write("pairs.yaml", "camera_to_camera: {distance_cm: 2, angle_deg: 0.5}\n");
  const std::string name = "calibrated_cameras_data.yml";
  const Comparison comparison = compare(load_result(folder_ / name), truth_);
  const Budget budget = load_budget(folder_ / "pairs.yaml");
  const json ours = json::parse(to_json({{name, comparison, budget, apply_budget(comparison, budget)}}));
  EXPECT_TRUE(ours["passed"]);
  EXPECT_EQ(ours["results"][0]["camera_to_camera"].size(), 2U) << "pairs of the first camera alone";
  const ProcessOutput output = score({file("truth.yaml"), file(name), "--budget", file("pairs.yaml"), "--json"});
  ASSERT_EQ(output.exit_code, 0) << output.err;
  expect_same(ours, json::parse(output.out), "");
}

TEST_F(Score, NotesOfAnyKindAreReadOrRefusedInWords) {
  const auto exit_code_of = [this](const std::string& notes, const std::string& expected) {
    folder_.write("noted.yaml",
                  "format: rigproof-result\nversion: 1\nmethod: ml\nstatus: refused\nnotes: " + notes + "\n");
    const ProcessOutput output = score({file("truth.yaml"), file("noted.yaml")});
    EXPECT_THAT(output.out + output.err, testing::HasSubstr(expected)) << notes;
    EXPECT_THAT(output.err, testing::Not(testing::HasSubstr("Traceback"))) << notes;
    return output.exit_code;
  };
  EXPECT_EQ(exit_code_of("hello", "notes: must be a list"), 2);
  EXPECT_EQ(exit_code_of("{a: 1}", "notes: must be a list"), 2);
  EXPECT_EQ(exit_code_of("[a sentence of an older version]", "FAIL"), 1);
  EXPECT_EQ(exit_code_of("[{severity: suspect}]", "FAIL"), 1);
}

TEST_F(Score, TellsPeopleWhatFailed) {
  save_result(exact_result(truth_), folder_ / "good.yaml", {});
  std::vector<Vector6d> errors(3, Vector6d::Zero());
  errors[2][1] = 0.02;
  save_result(make_result(truth_, errors), folder_ / "bad.yaml", {});
  folder_.write("limits.yaml", "camera_to_robot: {distance_cm: 1}\n");
  const std::vector<std::string> budget = {file("truth.yaml"), "--budget", file("limits.yaml")};
  std::vector<std::string> good = budget, bad = budget;
  good.push_back(file("good.yaml"));
  bad.push_back(file("bad.yaml"));
  EXPECT_EQ(score(good).exit_code, 0);
  const ProcessOutput output = score(bad);
  EXPECT_EQ(output.exit_code, 1);
  EXPECT_THAT(output.out, HasSubstr("failed: right in robot: ty: 2 cm, allowed 1 cm"));
  EXPECT_THAT(output.out, HasSubstr("FAIL  8/9 checks"));
}

TEST_F(Score, RefusesWhatItCannotJudge) {
  const std::string pose = "translation_m: [0, 0, 0], quaternion_xyzw: [0, 0, 0, 1]";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "holds no transform"},
      {"- {parent: robot, child: left}", "translation_m is missing"},
      {"- {parent: robot, child: left, translation_m: [0, 0], quaternion_xyzw: [0, 0, 0, 1]}", "a list of 3 numbers"},
      {"- {parent: robot, child: left, translation_m: [0, 0, .nan], quaternion_xyzw: [0, 0, 0, 1]}", "must be"},
      {"- {parent: robot, child: left, translation_m: [0, 0, 0], quaternion_xyzw: [0, 0, 0, 2]}", "the norm 2"},
      {"- {parent: robot, child: odd, " + pose + "}", "names no camera of the truth (cameras: left, center, right)"},
      {"- {parent: a, child: left, " + pose + "}\n- {parent: b, child: right, " + pose + "}", "more than one name"},
      {"- {parent: robot, child: left, " + pose + "}\n- {parent: robot, child: left, " + pose + "}", "given twice"},
      {"- {parent: robot, child: left, translation_m: [0, 0", "not closed"},
      {"- {parent: robot\n  child: left}", "a comma is missing"},
      {"a: &x 1", "anchors"},
      {"\xff\xfe", "no text"},
      {std::string(5000, '['), "no YAML that can be read"}};
  for (const auto& [text, message] : cases) {
    folder_.write("bad.yaml", text);
    const ProcessOutput output = score({file("truth.yaml"), file("bad.yaml")});
    EXPECT_EQ(output.exit_code, 2) << message;
    EXPECT_THAT(output.err, HasSubstr(message));
    EXPECT_THAT(output.err, testing::Not(HasSubstr("Traceback"))) << message;
    EXPECT_EQ(output.out, "");
  }
  EXPECT_EQ(score({file("nothing.yaml"), file("bad.yaml")}).exit_code, 2);
  EXPECT_EQ(score({file("truth.yaml")}).exit_code, 2);
}

}  // namespace
}  // namespace rigproof
