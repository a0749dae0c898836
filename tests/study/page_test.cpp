#include "rigproof/study/report/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "../validate/synthetic.h"
#include "rigproof/core/conventions.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using namespace testing_support;
using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kSigma_px = 0.05;

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

// What a browser finds in <script id="..">.
json element(const std::string& html, const std::string& id) {
  const std::string open = "id=\"" + id + "\">";
  const std::size_t begin = html.find(open) + open.size();
  return json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

class Page : public testing::Test {
 protected:
  Page() : truth_(make_truth(10)) {
    input_.observations = make_observations(truth_, kSigma_px);
    input_.truth = truth_;
    input_.results = {stated(exact_result(truth_), 0.001)};
    input_.input.path = "runs/known";
  }

  // The same with a sigma for every degree of freedom, all of it of one source.
  static Result stated(Result result, double sigma) {
    result.method = "ml";
    for (EstimatedTransform& camera : result.camera_to_robot) {
      camera.covariance = sigma * sigma * Matrix6d::Identity();
      camera.budget = {{"odometry", {1.0, 1.0, 1.0, 0.25, 0.25, 0.25}}, {"board", {0.0, 0.0, 0.0, 0.75, 0.75, 0.75}}};
    }
    for (const EstimatedTransform& camera : result.camera_to_robot) result.use.push_back({camera.child, 10, {}, 0.05});
    return result;
  }

  json data(const PageOptions& options = {}) const { return json::parse(page_content(input_, options).data); }

  Truth truth_;
  InspectInput input_;
};

TEST_F(Page, TellsOfAKnownRun) {
  input_.results[0].camera_to_robot[1].T_parent_child.translation.x() += 0.002;
  const json page = data();
  EXPECT_EQ(page["title"], "known");
  EXPECT_EQ(page["cameras"][2]["name"], "right");
  EXPECT_EQ(page["drive"]["driven"].size(), 10U);
  const json& result = page["results"][0];
  EXPECT_EQ(result["verdict"]["level"], "good");
  EXPECT_THAT(result["verdict"]["sentence"].get<std::string>(), HasSubstr("checks against the truth hold (4 sigma)"));
  const json& center = result["poses"][1];
  EXPECT_NEAR(center["error"][0].get<double>(), 0.002, 1e-8);
  EXPECT_NEAR(center["sigma"][0].get<double>(), 0.001, 1e-8);
  EXPECT_NEAR(center["values"][0].get<double>(), 0.362, 1e-8);
  EXPECT_NEAR(center["values"][5].get<double>(), deg_to_rad(-1.0), 1e-8);  // its yaw
  EXPECT_GT(center["bound"][0].get<double>(), 0.0);
  EXPECT_EQ(center["budget"][1]["share"][3], 0.75);
  EXPECT_EQ(page["frames"].size(), input_.observations.board_views.size());
}

// Six unknowns a board are fitted to what is left of the corners' noise.
TEST_F(Page, ResidualsOfARightRigAreTheCornersNoise) {
  const json fit = data()["results"][0]["corner_fit"];
  const double corners = fit["corners"], boards = fit["boards"];
  double sum = 0.0;
  for (const json& frame : fit["differences"])
    for (const json& value : frame) sum += std::pow(value.get<double>(), 2);
  ASSERT_GT(corners, 200.0);
  // Standard deviation of the ratio, which is a chi-square over its degrees of freedom: 0.06 for 500 of them.
  EXPECT_NEAR(sum / ((2.0 * corners - 6.0 * boards) * kSigma_px * kSigma_px), 1.0, 0.3);
}

// Rows are read while the robot moves, by a tenth faster than its odometry says: three more unknowns a board.
TEST_F(Page, ResidualsOfARollingShutterAreTheCornersNoise) {
  constexpr double kReadout_ms = 20.0;
  Observations& observations = input_.observations;
  for (std::size_t i = 0; i < truth_.stops.size(); ++i) {
    observations.stops[i].velocity << 0.4, 0.0, 0.3;
    truth_.stops[i].velocity = (Vector6d() << 0.44, 0.0, 0.0, 0.0, 0.0, 0.33).finished();
  }
  for (TrueCamera& camera : truth_.cameras) {
    camera.sensing["readout_ms"] = kReadout_ms;
    input_.results[0].also_estimated.push_back({camera.name, "readout_ms", kReadout_ms, 0.1, 15.0});
  }
  for (BoardView& view : observations.board_views) {
    const TrueStop& stop = truth_.stops[static_cast<std::size_t>(view.stop)];
    const auto camera = static_cast<std::size_t>(view.camera);
    const double middle = 0.5 * truth_.cameras[camera].camera.height_px - 0.5;
    for (CornerObservation& corner : view.corners) {
      Eigen::Vector2d standing, moving = corner.pixel;
      ASSERT_TRUE(truth_.project_corner(camera, stop, truth_, corner.id, middle, &standing));
      for (int round = 0; round < 5; ++round)
        ASSERT_TRUE(truth_.project_corner(camera, stop, truth_, corner.id, moving.y(), &moving));
      corner.pixel += moving - standing;
    }
  }
  input_.truth = truth_;
  const json page = data(), &fit = page["results"][0]["corner_fit"];
  const double corners = fit["corners"], boards = fit["boards"];
  double sum = 0.0, from_truth = 0.0;
  for (const json& frame : fit["differences"])
    for (const json& value : frame) sum += std::pow(value.get<double>(), 2);
  EXPECT_NEAR(sum / ((2.0 * corners - 9.0 * boards) * kSigma_px * kSigma_px), 1.0, 0.3);
  for (const json& frame : page["frames"])  // id, u, v and three of the covariance; u and v
    for (std::size_t i = 0; i < frame["true"].size(); ++i)
      from_truth +=
          std::pow(frame["corners"][6 * (i / 2) + 1 + i % 2].get<double>() - frame["true"][i].get<double>(), 2);
  EXPECT_NEAR(from_truth / (2.0 * corners * kSigma_px * kSigma_px), 1.0, 0.3);
}

TEST_F(Page, ResidualsShowACameraThatIsElsewhere) {
  input_.results[0].camera_to_robot[2].T_parent_child.translation.y() += 0.02;
  double largest = 0.0;
  const json fit = data()["results"][0]["corner_fit"];
  for (const json& frame : fit["differences"])
    for (const json& value : frame) largest = std::max(largest, std::abs(value.get<double>()));
  EXPECT_GT(largest, 10.0 * kSigma_px);
}

TEST_F(Page, WrongResultsAreBadAndDoubtfulOnesSuspect) {
  input_.results[0].notes = {Finding("board.moved_slightly")};
  EXPECT_EQ(data()["results"][0]["verdict"]["word"], "SUSPECT");
  input_.results[0].camera_to_robot[0].T_parent_child.translation.z() += 0.05;
  const json verdict = data()["results"][0]["verdict"];
  EXPECT_EQ(verdict["word"], "BAD");
  EXPECT_THAT(verdict["sentence"].get<std::string>(), HasSubstr("left tz"));
}

// Each error is 2.5 sigma: every check holds, all of them together are beyond chance.
TEST_F(Page, SigmasThatAreTooSmallAreSuspect) {
  for (EstimatedTransform& camera : input_.results[0].camera_to_robot)
    camera.T_parent_child.translation += Eigen::Vector3d::Constant(0.0025);
  input_.results[0].joint_covariance = 1e-6 * Eigen::MatrixXd::Identity(18, 18);
  json result = data()["results"][0];
  EXPECT_EQ(result["verdict"]["word"], "SUSPECT");
  EXPECT_EQ(result["verdict"]["level"], "suspect");
  const std::string sentence = result["verdict"]["sentence"];
  EXPECT_THAT(sentence, HasSubstr("checks against the truth hold (4 sigma); sigmas too small: NEES"));
  EXPECT_THAT(result["verdict"]["why"][0].get<std::string>(), HasSubstr("larger than the stated sigmas explain"));
  const json& shown = result["nees"]["as_in_verdict"];
  EXPECT_THAT(sentence, HasSubstr("NEES " + shown["value"].get<std::string>() +
                                  " (95 %: " + shown["within"].get<std::string>() + ")"));
  for (EstimatedTransform& camera : input_.results[0].camera_to_robot) *camera.covariance *= 100.0;
  *input_.results[0].joint_covariance *= 100.0;
  EXPECT_EQ(data()["results"][0]["verdict"]["word"], "GOOD") << "sigmas that are too large are cautious";
}

TEST_F(Page, ImagesThatContradictAResultWithinItsSigmasAreSuspect) {
  input_.results = {stated(exact_result(truth_), 0.05)};
  input_.results[0].camera_to_robot[2].T_parent_child.translation.y() += 0.02;
  const json verdict = data()["results"][0]["verdict"];
  EXPECT_EQ(verdict["word"], "SUSPECT");
  EXPECT_THAT(verdict["sentence"].get<std::string>(), HasSubstr("checks against the truth hold"));
  EXPECT_THAT(verdict["why"][0].get<std::string>(), HasSubstr("contradict each other"));
}

TEST_F(Page, RefusedAndPartialResultsSayWhy) {
  Result& result = input_.results[0];
  result.status = ResultStatus::kPartial;
  result.reasons = {Finding("motion.straight").along({"x", "y"})};
  for (EstimatedTransform& camera : result.camera_to_robot) camera.observable[0] = camera.observable[1] = false;
  json first = data()["results"][0];
  EXPECT_EQ(first["verdict"]["word"], "PARTIAL");
  EXPECT_EQ(first["verdict"]["level"], "suspect");
  EXPECT_THAT(first["verdict"]["why"][0].get<std::string>(), HasSubstr("x, y"));
  EXPECT_EQ(first["poses"][0]["T"], nullptr);
  EXPECT_EQ(first["poses"][0]["observable"][1], false);
  EXPECT_GT(first["corner_fit"]["corners"], 200) << "a view's own board needs no pose of its camera";
  result.status = ResultStatus::kRefused;
  result.camera_to_robot.clear();
  first = data()["results"][0];
  EXPECT_EQ(first["verdict"]["word"], "REFUSED");
  EXPECT_EQ(first["reasons"][0]["code"], "motion.straight");
  EXPECT_TRUE(first["poses"].empty());
}

TEST_F(Page, WithoutTruthTheStatedUncertaintyIsJudged) {
  input_.truth.reset();
  json page = data();
  EXPECT_EQ(page["has_truth"], false);
  EXPECT_EQ(page["results"][0]["poses"][0]["error"], nullptr);
  EXPECT_EQ(page["results"][0]["poses"][0]["bound"], nullptr);
  EXPECT_EQ(page["results"][0]["verdict"]["word"], "GOOD");
  EXPECT_THAT(page["results"][0]["verdict"]["sentence"].get<std::string>(),
              testing::ContainsRegex("least certain are t[xyz] of .* and (roll|pitch|yaw) of "));
  EXPECT_EQ(page["frames"][0].count("true"), 0U);
  input_.observations.accept = AcceptLimits{0.0005, 0.0, 0.0};
  page = data();
  EXPECT_EQ(page["results"][0]["verdict"]["word"], "BAD");
  EXPECT_THAT(page["results"][0]["verdict"]["why"][0].get<std::string>(),
              HasSubstr("tx of left: 0.1 cm, accepted up to 0.05 cm"));
}

TEST_F(Page, WithoutTruthWhatIsMissingOrContradictsIsNotGood) {
  input_.truth.reset();
  const Result good = input_.results[0];
  const auto verdict = [this] { return data()["results"][0]["verdict"]; };
  input_.results[0].camera_to_robot.pop_back();
  EXPECT_EQ(verdict()["word"], "PARTIAL");
  EXPECT_THAT(verdict()["sentence"].get<std::string>(), HasSubstr("Without a pose: right"));
  input_.results[0] = good;
  for (EstimatedTransform& camera : input_.results[0].camera_to_robot) camera.covariance.reset();
  EXPECT_EQ(verdict()["word"], "NOT JUDGED");
  input_.results[0] = good;
  std::swap(input_.results[0].camera_to_robot[0].child, input_.results[0].camera_to_robot[2].child);
  EXPECT_EQ(verdict()["word"], "SUSPECT");
  EXPECT_THAT(verdict()["why"][0].get<std::string>(), HasSubstr("contradict each other"));
}

TEST_F(Page, MissingPiecesAreLeftOut) {
  input_.observations.board_views.clear();
  input_.observations.ground_planes.clear();
  input_.observations.stops.clear();
  input_.results[0].use.clear();
  const PageContent content = page_content(input_);
  const json page = json::parse(content.data);
  EXPECT_TRUE(page["frames"].empty());
  EXPECT_TRUE(page["drive"]["driven"].empty());
  EXPECT_EQ(json::parse(content.images), json::array());
  EXPECT_THAT(page_html(content), HasSubstr("</html>"));
}

TEST_F(Page, OneResultAtLeastAndTheOneThatIsAskedForComesFirst) {
  Result other = input_.results[0];
  other.method = "joint_memroc";
  input_.results.insert(input_.results.begin(), other);
  EXPECT_EQ(data()["results"][0]["method"], "ml");
  PageOptions options;
  options.method = "joint_memroc";
  EXPECT_EQ(data(options)["results"][0]["method"], "joint_memroc");
  EXPECT_EQ(data(options)["results"][1]["method"], "ml");
  options.method = "joint_memrok";
  try {
    data(options);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean \"joint_memroc\""));
  }
  input_.results.clear();
  EXPECT_THROW(data(), Error);
}

TEST_F(Page, WhatIsNotFiniteIsNull) {
  input_.results[0].residuals = {{"corners", "px", 3, std::nan("")}, {"odometry", "m", 3, INFINITY}};
  const json groups = data()["results"][0]["residuals"];
  EXPECT_EQ(groups[0]["rms"], nullptr);
  EXPECT_EQ(groups[1]["rms"], nullptr);
}

TEST_F(Page, HostileTextStaysText) {
  const std::string hostile = "</script><script>alert('\"1\"')</script><!-- {{data}} \xF0\x9F\xA4\x96 &amp; \\u003c";
  input_.input.path = "runs/</title><script>alert(2)</script>";
  input_.observations.source = hostile + " \xFF";  // no UTF-8
  input_.results[0].method = hostile;
  input_.results[0].notes = {Finding("stated", {{"text", hostile}})};
  const PageContent content = page_content(input_);
  const std::string html = page_html(content);
  const std::string harmless = page_html({"t", "{}", "[]"});
  EXPECT_EQ(count_of(html, "</script"), count_of(harmless, "</script"));
  EXPECT_EQ(count_of(html, "<script"), count_of(harmless, "<script"));
  EXPECT_EQ(count_of(html, "<!--"), count_of(harmless, "<!--"));
  const json page = element(html, "report-data");
  EXPECT_EQ(page["results"][0]["method"], hostile);
  EXPECT_EQ(page["results"][0]["notes"][0]["sentence"], hostile);
}

TEST_F(Page, NothingMayBeLoadedAndOnlyItsOwnScriptsRun) {
  const std::string html = page_html({"t", "{}", "[]"});
  EXPECT_THAT(html, HasSubstr("default-src 'none'; img-src data:;"));
  EXPECT_EQ(count_of(html, "'sha256-"), 3U);
  EXPECT_EQ(count_of(html, "<script>"), 3U);
  EXPECT_EQ(count_of(html, "src=\"http"), 0U);
}

TEST_F(Page, ImagesAreSmallAndTheBoardIsCutOut) {
  const TempFolder folder;
  Recording recording;
  recording.folder = folder.path();
  recording.rig.cameras = input_.observations.cameras;
  for (std::size_t i = 0; i < input_.observations.board_views.size(); ++i) {
    BoardView& view = input_.observations.board_views[i];
    view.file = "image" + std::to_string(i) + ".png";
    if (i == 1) continue;  // missing
    cv::imwrite((folder / view.file).string(), cv::Mat(360, 640, CV_8UC3, cv::Scalar(10, 120, 230)));
  }
  input_.input.recording = recording;
  PageOptions options;
  options.max_images = 4;
  const std::size_t frames = input_.observations.board_views.size();
  json images = json::parse(page_content(input_, options).images);
  ASSERT_EQ(images.size(), frames);
  EXPECT_EQ(std::count(images.begin(), images.end(), nullptr), static_cast<std::ptrdiff_t>(frames) - 4);
  images = json::parse(page_content(input_).images);
  EXPECT_EQ(std::count(images.begin(), images.end(), nullptr), 1);
  ASSERT_EQ(images[0].size(), 3U);
  EXPECT_TRUE(images[0][2].is_null()) << "no depth, no ground";
  EXPECT_EQ(images[0][0].get<std::string>().rfind("/9j/", 0), 0U) << "a JPEG in base 64";
  EXPECT_LT(images[0][0].get<std::string>().size(), 20000U);
  options.max_frames = 3;
  EXPECT_EQ(json::parse(page_content(input_, options).images).size(), 3U);
  EXPECT_EQ(data(options)["frames"].size(), 3U);
  options.progress = [](std::size_t done, std::size_t) { return done < 2; };
  EXPECT_THROW(page_content(input_, options), Error);
}

// 1/z = a . ray of the ground z = 0, in the camera.
PlaneObservation ground_plane(const Truth& truth, const BoardView& view, const std::string& file) {
  const Rigid3 T_world_camera = truth.stops[static_cast<std::size_t>(view.stop)].T_world_robot *
                                truth.cameras[static_cast<std::size_t>(view.camera)].T_robot_camera;
  PlaneObservation plane;
  plane.stop = view.stop;
  plane.camera = view.camera;
  plane.file = file;
  plane.inverse_depth_plane =
      -(T_world_camera.rotation.conjugate() * Eigen::Vector3d::UnitZ()) / T_world_camera.translation.z();
  plane.residual_rms = 1.0;
  return plane;
}

TEST_F(Page, WhereTheGroundIsSeenIsTold) {
  const TempFolder folder;
  DepthFaults furniture;
  furniture.furniture = true;  // in the left quarter
  input_.input.recording = make_depth_recording(truth_, folder.path(), furniture);
  BoardView& view = input_.observations.board_views[0];
  const Camera& camera = truth_.cameras[static_cast<std::size_t>(view.camera)].camera;
  view.file = "image.png";
  cv::imwrite((folder / view.file).string(), cv::Mat(camera.height_px, camera.width_px, CV_8UC3, cv::Scalar::all(90)));
  const auto& frames = input_.input.recording->frames[static_cast<std::size_t>(view.camera)];
  const PlaneObservation plane = ground_plane(truth_, view, frames[static_cast<std::size_t>(view.stop)].depth_file);
  input_.observations.ground_planes = {plane};
  const json listed = data()["frames"];
  const auto shown = std::find_if(listed.begin(), listed.end(), [&](const json& f) { return f["file"] == view.file; });
  const auto index = static_cast<std::size_t>(shown - listed.begin());
  const json ground = json::parse(page_content(input_).images).at(index).at(2);
  const int columns = ground[0];
  const std::string cells = ground[1];
  const int rows = static_cast<int>(cells.size()) / columns;
  int right = 0, above = 0, left = 0;
  for (int i = 0; i < columns * rows; ++i) {
    Eigen::Vector3d ray;
    const Eigen::Vector2d centre((i % columns + 0.5) * camera.width_px / columns - 0.5,
                                 (i / columns + 0.5) * camera.height_px / rows - 0.5);
    camera.unproject(centre, &ray);
    const bool ground_here = cells[static_cast<std::size_t>(i)] == 'g';
    if (plane.inverse_depth_plane.dot(ray) < 0.0) above += ground_here;
    if (i / columns == rows - 1) (4 * (i % columns) < columns - 8 ? left : right) += ground_here;
  }
  EXPECT_EQ(above, 0) << "no ground above the horizon";
  EXPECT_EQ(left, 0) << "things stand there";
  EXPECT_GE(right, columns * 3 / 4) << "the lowest row is floor";
  std::filesystem::remove(folder / plane.file);
  EXPECT_TRUE(json::parse(page_content(input_).images).at(index).at(2).is_null())
      << "depth that cannot be read is no error";
}

SweepRows two_answers() {
  SweepRows rows;
  rows.name = "two";
  rows.axes = {"lambda"};
  rows.axis_titles = {"odometry noise lambda"};
  rows.pooled = {false};
  rows.levels = {{"1", "5"}};
  rows.level_values = {{1.0, 5.0}};
  rows.methods = {"ml", "memroc"};
  rows.reference = "ml";
  rows.tasks = {{"a", {0}, 7, {}}, {"b", {1}, 8, {}}};
  SweepRow row;
  row.task = "b";
  row.levels = {"5"};
  row.method = "memroc";
  row.subject = SweepSubject::kCamera;
  row.camera = "left";
  row.status = SweepStatus::kPartial;
  row.error = {-0.123456, 0.2, std::nullopt, 0.01, 0.02, 0.03};
  rows.rows = {row};
  row.subject = SweepSubject::kRig;
  row.camera = "all";
  row.error = {};
  row.nees = 7.25;
  row.nees_degrees_of_freedom = 5;
  row.reasons = {Finding("motion.straight")};
  rows.rows.push_back(row);
  return rows;
}

TEST(SweepPage, HoldsEveryAnswerInColumns) {
  const json page = json::parse(sweep_page_content(two_answers()).data);
  EXPECT_EQ(page["kind"], "sweep");
  EXPECT_EQ(page["axes"][0]["levels"], json({"1", "5"}));
  EXPECT_EQ(page["tasks"], json({{0, 7}, {1, 8}}));
  EXPECT_EQ(page["rows"]["task"], json({1, 1}));
  EXPECT_EQ(page["rows"]["method"], json({1, 1}));
  EXPECT_EQ(page["subjects"], json({"camera:left", "rig:all"}));
  EXPECT_EQ(page["statuses"], json({"partial"}));
  EXPECT_EQ(page["rows"]["error"][0], json({-0.123, 0.2, nullptr, 0.01, 0.02, 0.03}));
  EXPECT_EQ(page["rows"]["error"][1], nullptr);
  EXPECT_EQ(page["rows"]["nees"], json({nullptr, 7.25}));
  EXPECT_EQ(page["rows"]["nees_dof"], json({0, 5}));
  EXPECT_EQ(page["failures"][0]["code"], "motion.straight");
}

TEST(SweepPage, WritesOnceWhatManyRowsInSuccessionShare) {
  SweepRows rows = two_answers();
  for (int i = 0; i < 6; ++i) rows.rows.insert(rows.rows.begin(), rows.rows.front());
  const json columns = json::parse(sweep_page_content(rows).data)["rows"];
  EXPECT_EQ(columns["task"], json({{"runs", {1, 8}}}));
  EXPECT_EQ(columns["status"], json({{"runs", {0, 8}}}));
  EXPECT_EQ(columns["nees"], json({{"runs", {nullptr, 7, 7.25, 1}}}));
  EXPECT_EQ(columns["nees_dof"], json({{"runs", {0, 7, 5, 1}}}));
  EXPECT_EQ(columns["subject"].size(), 8U);
  EXPECT_EQ(columns["error"].size(), 8U);
}

TEST(SweepPage, TellsWhichDriversDrewThePictures) {
  SweepRows rows = two_answers();
  EXPECT_EQ(json::parse(sweep_page_content(rows).data)["gl_renderers"], json::array());
  rows.machines = {{{"a", "cpu", "llvmpipe"}, 3}, {{"b", "cpu", "llvmpipe"}, 4}, {{"c", "cpu", "card"}, 2}, {{}, 1}};
  EXPECT_EQ(json::parse(sweep_page_content(rows).data)["gl_renderers"],
            json({{{"name", "card"}, {"answers", 2}}, {{"name", "llvmpipe"}, {"answers", 7}}}));
}

TEST(SweepPage, NothingDoneIsAnError) {
  SweepRows rows = two_answers();
  rows.rows.clear();
  EXPECT_THROW(sweep_page_content(rows), Error);
}

TEST_F(Page, IsWrittenWholeOrNotAtAll) {
  const TempFolder folder;
  write_page(input_, folder / "report.html");
  EXPECT_THAT(read_text_file(folder / "report.html"), HasSubstr("</html>"));
  fs::create_directory(folder / "folder.html");
  EXPECT_THROW(write_page(input_, folder / "folder.html"), Error);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

}  // namespace
}  // namespace rigproof
