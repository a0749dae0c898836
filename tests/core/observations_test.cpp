#include "rigproof/core/observations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "error_text.h"
#include "sample_data.h"
#include "temp_folder.h"
#include "worded.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

struct SavedObservations : TempFolder {
  SavedObservations() { save_observations(sample_observations(), *this / "o.json"); }
  std::string problems_with(const std::string& from, const std::string& to) const {
    write("bad.json", replaced(read("o.json"), from, to));
    return error_text([this] { load_observations(*this / "bad.json"); });
  }
};

TEST(Observations, RoundTripKeepsEveryValueAndEveryByte) {
  const SavedObservations folder;
  const Observations a = sample_observations(), b = load_observations(folder / "o.json");
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.board, b.board);
  ASSERT_EQ(b.cameras.size(), 3U);
  EXPECT_EQ(b.cameras[0].name, "left") << "the order of the cameras is their index";
  EXPECT_EQ(b.cameras[1].name, "center");
  ASSERT_EQ(a.board_views.size(), b.board_views.size());
  for (std::size_t i = 0; i < a.board_views.size(); ++i)
    for (std::size_t j = 0; j < a.board_views[i].corners.size(); ++j) {
      const CornerObservation &p = a.board_views[i].corners[j], &q = b.board_views[i].corners[j];
      EXPECT_EQ(p.id, q.id);
      EXPECT_EQ(p.pixel, q.pixel);
      EXPECT_EQ(p.covariance_px2, q.covariance_px2);
    }
  ASSERT_EQ(a.ground_planes.size(), b.ground_planes.size());
  EXPECT_EQ(a.ground_planes[2].covariance_per_m2, b.ground_planes[2].covariance_per_m2);
  EXPECT_EQ(a.ground_planes[2].inverse_depth_plane, b.ground_planes[2].inverse_depth_plane);
  EXPECT_EQ(a.stops[1].yaw_rad, b.stops[1].yaw_rad);
  EXPECT_TRUE(b.stops[0].way.empty());
  EXPECT_EQ(a.stops[1].way, b.stops[1].way);
  EXPECT_TRUE(b.stops[0].velocity.isZero(0.0));
  EXPECT_EQ(a.stops[1].velocity, b.stops[1].velocity);
  EXPECT_TRUE(b.stops[0].acceleration.isZero(0.0));
  EXPECT_EQ(a.stops[1].acceleration, b.stops[1].acceleration);
  EXPECT_EQ(a.odometry_noise.rotation_centre_m, b.odometry_noise.rotation_centre_m);
  EXPECT_EQ(a.exclusions[1].why, b.exclusions[1].why);
  EXPECT_EQ(b.exclusions[1].stop, -1);
  save_observations(b, folder / "again.json");
  EXPECT_EQ(folder.read("o.json"), folder.read("again.json"));
}

TEST(Observations, KeysThatWereSortedExchangeNoCameras) {
  const SavedObservations folder;
  const auto sorted = nlohmann::json::parse(folder.read("o.json"));
  folder.write("sorted.json", sorted.dump());
  const Observations o = load_observations(folder / "sorted.json");
  std::vector<std::string> names;
  for (const RigCamera& camera : o.cameras) names.push_back(camera.name);
  EXPECT_THAT(names, testing::ElementsAre("left", "center", "right"));
  EXPECT_EQ(o.cameras[1].camera.fx_px, sample_observations().cameras[1].camera.fx_px);
  nlohmann::json wrong = sorted;
  wrong["camera_order"] = {"left", "left", "right"};
  folder.write("wrong.json", wrong.dump());
  EXPECT_THAT(error_text([&] { load_observations(folder / "wrong.json"); }),
              HasSubstr("camera_order: a list of 3: must name each of the cameras once: "));
}

TEST(Observations, TellWhichBoardAViewIsOf) {
  TempFolder folder;
  Observations written = sample_observations();
  save_observations(written, folder / "one.json");
  EXPECT_EQ(folder.read("one.json").find("more_boards"), std::string::npos);
  Board larger = written.board;
  larger.squares_x += 2;
  written.more_boards = {larger};
  BoardView& view = written.board_views.back();
  view.board = 1;
  view.corners = {view.corners.front()};
  view.corners.front().id = larger.corner_count() - 1;
  save_observations(written, folder / "two.json");
  const Observations read = load_observations(folder / "two.json");
  ASSERT_EQ(read.boards(), 2);
  EXPECT_EQ(read.more_boards[0], larger);
  EXPECT_EQ(read.board_views.front().board, 0);
  EXPECT_EQ(read.board_views.back().board, 1);
  EXPECT_EQ(read.board_of(read.board_views.back()).corner_count(), larger.corner_count());
  save_observations(read, folder / "again.json");
  EXPECT_EQ(folder.read("two.json"), folder.read("again.json"));

  written.board_views.back().board = 0;
  save_observations(written, folder / "small.json");
  EXPECT_THAT(error_text([&] { load_observations(folder / "small.json"); }),
              HasSubstr("a corner's id must be a whole number"));
  for (const int board : {2, -1}) {
    written.board_views.back().board = board;
    save_observations(written, folder / "none.json");
    EXPECT_THAT(error_text([&] { load_observations(folder / "none.json"); }),
                HasSubstr("board: " + std::to_string(board) + ": allowed is 0 to 1"));
  }
}

TEST(Observations, OneElementALine) {
  const SavedObservations folder;
  EXPECT_THAT(folder.read("o.json"), HasSubstr("\n  {\"stop\": 1, \"camera\": 0, \"stamp_s\": 1.1, \"file\":"));
}

TEST(Observations, EveryKindOfProblemIsNamed) {
  const SavedObservations f;
  const auto stop = "{\"stop\": 1, \"camera\": 0";
  EXPECT_THAT(f.problems_with(stop, "{\"stop\": 2, \"camera\": 0"),
              HasSubstr("board_views[2].stop: 2: allowed is 0 to 1"));
  EXPECT_THAT(f.problems_with(stop, "{\"stop\": 1, \"camera\": -1"),
              HasSubstr("board_views[2].camera: -1: allowed is 0 to 2"));
  EXPECT_THAT(f.problems_with(stop, "{\"stop\": 1.0, \"camera\": 0"), HasSubstr("must be a whole number"));
  EXPECT_THAT(f.problems_with("\"corners\": [[0,", "\"corners\": [[20,"), HasSubstr("a corner's id must be"));
  EXPECT_THAT(f.problems_with("\"corners\": [[0,", "\"corners\": [[1,"), HasSubstr("a corner is given twice"));
  EXPECT_THAT(f.problems_with("\"corners\": [[0,", "\"corners\": [[0, 1,"), HasSubstr("a corner must be [id,"));
  EXPECT_THAT(f.problems_with("\"effective_points\": ", "\"effective_points\": -"),
              HasSubstr("ground_planes[0].effective_points: -"));
  EXPECT_THAT(f.problems_with("\"effective_points\"", "\"efective_points\""), HasSubstr("is missing"));
  EXPECT_THAT(f.problems_with("\"code\"", "\"x\": 1, \"code\""), HasSubstr("exclusions[0].x: unknown key"));
  EXPECT_THAT(f.problems_with("\"x_m\": ", "\"x_m\": 1e999, \"_\": "), HasSubstr("not valid JSON"));
  EXPECT_THAT(f.problems_with("\"x_m\": ", "\"x_m\": null, \"_\": "),
              HasSubstr("stops[0].x_m: nothing: must be a finite"));
  EXPECT_THAT(f.problems_with("\"way\": [[", "\"way\": [[0, "),
              HasSubstr("stops[1].way[0]: a list of 4: must be a list of 3"));
  EXPECT_THAT(f.problems_with("\"yaw_acceleration_rad_per_s2\": -2.5", "\"yaw_acceleration_rad_per_s2\": 1e308"),
              HasSubstr("stops[1].yaw_acceleration_rad_per_s2: 1e+308: allowed is -1000 to 1000"));
  EXPECT_THAT(f.problems_with("\"velocity_m_per_s\": [0.31", "\"velocity_m_per_s\": [1e308"),
              HasSubstr("stops[1].velocity_m_per_s"));
  EXPECT_THAT(f.problems_with("\"way\": [", "\"way\": 7, \"x\": ["), HasSubstr("stops[1].way: 7: must be a list"));
  EXPECT_THAT(f.problems_with("rigproof-observations", "rigproof-result"),
              HasSubstr("must be one of rigproof-observations"));
  EXPECT_THAT(f.problems_with("\"version\": 2", "\"version\": 3"), HasSubstr("version: 3: allowed is 1 to 2"));
  EXPECT_THAT(f.problems_with("\"accept\"", "\"acept\""), HasSubstr("did you mean \"accept\"?"));
  EXPECT_THAT(f.problems_with("\"fx_px\"", "\"fx\""), HasSubstr("cameras.left.intrinsics.fx_px: is missing"));
}

TEST(Observations, CovariancesMustBePositive) {
  Observations o = sample_observations();
  const TempFolder folder;
  o.board_views[0].corners[0].covariance_px2 << 1.0, 2.0, 2.0, 1.0;
  o.ground_planes[0].covariance_per_m2 << 1.0, 0.9, -0.9, 0.9, 1.0, 0.9, -0.9, 0.9, 1.0;
  save_observations(o, folder / "o.json");
  const std::string text = error_text([&] { load_observations(folder / "o.json"); });
  EXPECT_THAT(text,
              HasSubstr("board_views[0].corners: a list of 4: entry 0: the covariance of a corner must be positive"));
  EXPECT_THAT(text, HasSubstr("ground_planes[0].covariance_per_m2: a list of 6: must be the upper triangle"));
}

TEST(Observations, ViewsMustBeSorted) {
  Observations o = sample_observations();
  const TempFolder folder;
  std::swap(o.board_views[0], o.board_views[3]);
  save_observations(o, folder / "o.json");
  EXPECT_THAT(error_text([&] { load_observations(folder / "o.json"); }),
              HasSubstr("board_views[1]: must be sorted by stop, then camera"));
}

// Each would count as a measurement of its own.
TEST(Observations, WhatIsGivenTwiceIsRefused) {
  const TempFolder folder;
  const auto problems_of = [&folder](const Observations& o) {
    save_observations(o, folder / "o.json");
    return error_text([&] { load_observations(folder / "o.json"); });
  };
  const auto twice = [](auto* list) { list->insert(list->begin() + 1, list->front()); };
  Observations views = sample_observations(), ground = views, board = views;
  twice(&views.board_views);
  EXPECT_THAT(problems_of(views), HasSubstr("board_views[1]: is of stop 0 and camera 0, as the entry before; one "
                                            "entry a stop and camera is allowed"));
  twice(&ground.ground_planes);
  EXPECT_THAT(problems_of(ground), HasSubstr("ground_planes[1]: is of stop 0 and camera 0, as the entry before"));
  twice(&board.board_planes);
  EXPECT_THAT(problems_of(board), HasSubstr("board_planes[1]: is of stop 0 and camera 0, as the entry before"));
}

TEST(Observations, StampsOfStopsMustIncrease) {
  Observations o = sample_observations();
  const TempFolder folder;
  const auto problems_with = [&](double first_s, double second_s) {
    o.stops[0].stamp_s = first_s;
    o.stops[1].stamp_s = second_s;
    save_observations(o, folder / "o.json");
    return error_text([&] { load_observations(folder / "o.json"); });
  };
  EXPECT_EQ(problems_with(2.0, 3.0), "");
  EXPECT_THAT(problems_with(3.5, 2.0), HasSubstr("stops[1].stamp_s: 2: is earlier than the stamp of the stop before, "
                                                 "3.5; stops stand in the order of driving, and stamps must"));
  EXPECT_THAT(problems_with(2.0, 2.0), HasSubstr("stops[1].stamp_s: 2: repeats the stamp of the stop before"));
}

TEST(Observations, DeepOrForeignJsonIsRefused) {
  const TempFolder folder;
  const auto load = [&](const std::string& text) {
    folder.write("o.json", text);
    return error_text([&] { load_observations(folder / "o.json"); });
  };
  EXPECT_THAT(load(std::string(1000000, '[')), HasSubstr("nested deeper than 12 levels"));
  EXPECT_THAT(load("[1, 2]"), HasSubstr("must be an object with format rigproof-observations"));
  EXPECT_THAT(load(""), HasSubstr("not valid JSON"));
  EXPECT_THAT(load("{}"), HasSubstr("format: is missing"));
}

// A file that moves to another machine must not need that machine's presets.
TEST(Observations, NeedNoPresets) {
  Observations o = sample_observations();
  o.cameras[0].sensor = "a_sensor_of_tomorrow";
  const TempFolder folder;
  save_observations(o, folder / "o.json");
  EXPECT_EQ(load_observations(folder / "o.json").cameras[0].sensor, "a_sensor_of_tomorrow");
}

}  // namespace
}  // namespace rigproof
