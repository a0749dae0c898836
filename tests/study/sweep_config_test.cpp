// The file of a sweep: what it makes of fields, axes and seeds, and what it says of mistakes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "error_text.h"
#include "rigproof/core/yaml.h"
#include "rigproof/study/sweep/config.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

SweepConfig read(const std::string& text) {
  const TempFolder folder;
  return load_sweep_config(folder.write("trial.yaml", text));
}

std::string problem_of(const std::string& text) {
  return error_text([&] { read(text); });
}

std::vector<std::string> labels_of(const SweepAxis& axis) {
  std::vector<std::string> labels;
  for (const SweepLevel& level : axis.levels) labels.push_back(level.label);
  return labels;
}

TEST(SweepConfig, AnEmptyFileIsOneTask) {
  const SweepConfig config = read("");
  EXPECT_EQ(config.name, "trial");
  ASSERT_EQ(config.methods.size(), 1U);
  EXPECT_EQ(config.methods[0].label(), "ml");
  const std::vector<SweepTask> tasks = plan_sweep(config);
  ASSERT_EQ(tasks.size(), 1U);
  EXPECT_FALSE(tasks[0].pictures.empty());
}

TEST(SweepConfig, AxesGiveEveryCombinationTheLastFastest) {
  const SweepConfig config = read(R"(
mode: geometric
run: {poses: 12, odometry: {sigma_xy_cm: 0.3}}
axes:
  lambda: {field: odometry.lambda, range: {from: 0, to: 0.3, step: 0.1}, title: noise}
  corner: {field: geometric.corner_sigma_px, range: {from: 0.01, to: 1, count: 3, spacing: log}}
  model: {field: odometry.model, values: [per_pose, per_increment], labels: [absolute, relative], pool: true}
seeds: {first: 7, count: 2}
)");
  ASSERT_EQ(config.axes.size(), 3U);
  EXPECT_EQ(labels_of(config.axes[0]), (std::vector<std::string>{"0", "0.1", "0.2", "0.3"}));
  EXPECT_EQ(labels_of(config.axes[1]), (std::vector<std::string>{"0.01", "0.1", "1"}));
  EXPECT_EQ(labels_of(config.axes[2]), (std::vector<std::string>{"absolute", "relative"}));
  EXPECT_EQ(config.axes[0].title, "noise");
  EXPECT_TRUE(config.axes[2].pooled);
  EXPECT_DOUBLE_EQ(config.axes[0].levels[3].value, 0.3);
  const std::vector<SweepTask> tasks = plan_sweep(config);
  ASSERT_EQ(tasks.size(), 48U);
  const auto settings = [&](std::size_t i) { return settings_of(config, tasks[i]); };
  EXPECT_EQ(tasks[0].seed, 7);
  EXPECT_EQ(tasks[1].seed, 8);
  EXPECT_EQ(settings(1).config.seed, 8);
  EXPECT_EQ(settings(2).config.odometry.model, "per_increment");
  EXPECT_DOUBLE_EQ(settings(4).geometric.corner_sigma_px, 0.1);
  EXPECT_DOUBLE_EQ(settings(47).config.odometry.lambda, 0.3);
  EXPECT_DOUBLE_EQ(settings(0).config.odometry.sigma_xy_cm, 0.3) << "fields beside a varied one stay";
  EXPECT_TRUE(tasks[0].pictures.empty());
}

TEST(SweepConfig, FieldsVaryTogether) {
  const SweepConfig config = read(R"(
run: {poses: 20}
axes:
  board:
    points:
      small: {board.squares: [5, 4], board.square_mm: 60}
      large: {board.squares: [6, 5], board.square_mm: 110}
  noise: {link: {odometry.lambda: [1, 2], odometry.rate_hz: [0, 10]}}
)");
  EXPECT_EQ(labels_of(config.axes[0]), (std::vector<std::string>{"small", "large"}));
  const std::vector<SweepTask> tasks = plan_sweep(config);
  ASSERT_EQ(tasks.size(), 4U);
  const GenerateConfig last = settings_of(config, tasks[3]).config;
  EXPECT_DOUBLE_EQ(last.board.square_mm, 110.0);
  EXPECT_EQ(last.board.squares, (std::vector<double>{6.0, 5.0}));
  EXPECT_DOUBLE_EQ(last.odometry.rate_hz, 10.0);
}

TEST(SweepConfig, OnlyWhatPicturesDependOnMakesOtherPictures) {
  const auto sets_of = [](const SweepConfig& config) {
    std::map<std::string, PictureSet> sets;
    for (const SweepTask& task : plan_sweep(config)) sets.emplace(task.pictures, pictures_of(config, task));
    std::vector<PictureSet> list;
    for (const auto& [key, set] : sets) list.push_back(set);
    return list;
  };
  const auto sets = [&](const std::string& axis, const std::string& seed_field) {
    return sets_of(read("axes: {a: " + axis + "}\nseeds: {count: 3, field: " + seed_field + "}\n"));
  };
  EXPECT_EQ(sets("{field: odometry.lambda, values: [0, 5]}", "odometry.seed").size(), 1U);
  EXPECT_EQ(sets("{field: images, values: [5, 50]}", "odometry.seed").size(), 1U);
  EXPECT_EQ(sets("{field: odometry.lambda, values: [0, 5]}", "seed").size(), 3U);
  const std::vector<PictureSet> noisy = sets("{field: sensor_noise, values: [none, realistic]}", "odometry.seed");
  ASSERT_EQ(noisy.size(), 2U);
  EXPECT_EQ(noisy[0].render_group, noisy[1].render_group) << "the same clean renders";
  const std::vector<PictureSet> worlds = sets("{field: scene, values: [indoor_lab, office]}", "odometry.seed");
  ASSERT_EQ(worlds.size(), 2U);
  EXPECT_NE(worlds[0].render_group, worlds[1].render_group);
  EXPECT_EQ(sets_of(read("run: {motion: drive}\naxes: {r: {field: odometry.rate_hz, values: [20, 50]}}")).size(), 2U)
      << "a robot that really drives";
}

TEST(SweepConfig, TasksAreKnownByWhatTheyDependOn) {
  const std::string text = "mode: geometric\nname: NAME\naxes: {l: {field: odometry.lambda, values: [1, 2]}}\n";
  const auto key = [&](const std::string& name, const std::string& more) {
    std::string changed = text + more;
    return plan_sweep(read(changed.replace(changed.find("NAME"), 4, name)))[1].key;
  };
  EXPECT_EQ(key("one", ""), key("two", "methods: [li]\n"));
  EXPECT_NE(key("one", ""), key("one", "run: {poses: 30}\n"));
  EXPECT_NE(key("one", ""), key("one", "geometric: {ground: false}\n"));
}

TEST(SweepConfig, TheResolvedFileReadsBack) {
  const SweepConfig config = read(R"(
mode: geometric
axes:
  squares: {field: geometric.cameras, values: [2, 3]}
  odd: {points: {a: {poses: 10}, "b, c": {poses: 11, odometry.scale: {uniform: [0.9, 1.1]}}}}
geometric: {rig: random}
seeds: [4, 2]
methods: [memroc, li]
)");
  EXPECT_EQ(config.reference, "memroc");
  const SweepConfig again = read(emit_yaml(resolved_sweep(config)));
  EXPECT_EQ(emit_yaml(resolved_sweep(again)), emit_yaml(resolved_sweep(config)));
  const std::vector<SweepTask> one = plan_sweep(config), two = plan_sweep(again);
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].key, two[i].key);
}

TEST(SweepConfig, MethodsSayHowTheyLookAtImages) {
  const SweepConfig config = read(R"(
ground: auto
methods:
  - ml
  - {method: memroc, ground: depth}
  - {method: memroc, name: memroc_image_ground, ground: images, features: "onnx:net.onnx"}
reference: memroc_image_ground
)");
  ASSERT_EQ(config.methods.size(), 3U);
  EXPECT_EQ(config.methods[0].vision.ground, "auto");
  EXPECT_EQ(config.methods[1].vision.ground, "depth");
  EXPECT_EQ(config.methods[1].label(), "memroc");
  EXPECT_EQ(config.methods[2].vision.ground, "images");
  EXPECT_THAT(config.methods[2].vision.features, AllOf(StartsWith("onnx:/"), EndsWith("/net.onnx")));
  EXPECT_EQ(config.reference, "memroc_image_ground");
  const SweepConfig again = read(emit_yaml(resolved_sweep(config)));
  EXPECT_EQ(emit_yaml(resolved_sweep(again)), emit_yaml(resolved_sweep(config)));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again.methods[i].label(), config.methods[i].label());
    EXPECT_EQ(again.methods[i].vision.text(), config.methods[i].vision.text());
  }
  EXPECT_EQ(read("ground: images").methods[0].vision.ground, "images");
  EXPECT_EQ(read("methods: [li, memroc]").reference, "li");

  EXPECT_THAT(problem_of("ground: lidar"), AllOf(HasSubstr("ground"), HasSubstr("lidar"), HasSubstr("images")));
  EXPECT_THAT(problem_of("features: orb"), HasSubstr("must be sift or onnx:FILE"));
  EXPECT_THAT(problem_of("horizon: sift"), HasSubstr("must be onnx:FILE"));
  EXPECT_THAT(problem_of("methods:\n  - {method: ml,\n     grond: images}\n"),
              AllOf(HasSubstr("trial.yaml:3"), HasSubstr("did you mean \"ground\"")));
  EXPECT_THAT(problem_of("methods: [{name: a}]"), HasSubstr("methods[0].method"));
  EXPECT_THAT(problem_of("methods: [{method: ml, name: a b}]"), HasSubstr("must be letters, digits"));
  EXPECT_THAT(problem_of("methods: [ml, {method: ml, ground: images}]"),
              HasSubstr("ml is in the list twice; `name` tells one method's variants apart"));
}

TEST(SweepConfig, MeasuredNoiseGoesWithARunOnly) {
  EXPECT_THAT(problem_of("mode: geometric\ngeometric: {measured: seen.json}\n"), HasSubstr("needs rig: run"));
  EXPECT_THAT(problem_of("mode: geometric\ngeometric: {rig: run, measured: seen.json, corner_sigma_px: 0.02}\n"),
              HasSubstr("corner_sigma_px"));
  EXPECT_THAT(problem_of("mode: geometric\nrun: {board: {preset: charuco_7x5_100mm}, more_boards: [{preset: "
                         "aprilgrid_6x4_130mm, x_m: 0, y_m: 4, facing_deg: -90}]}\n"),
              HasSubstr("more_boards: 1: must be none in mode geometric, unless geometric.rig is run"));
  EXPECT_THAT(problem_of("mode: geometric\ngeometric: {rig: run, measured: no_such.json}\n"),
              HasSubstr("no_such.json"));
  EXPECT_THAT(problem_of("mode: geometric\ngeometric: {rig: run, depth_scale_sigma: 0.01}\n"),
              HasSubstr("depth_scale_sigma"));
  EXPECT_THAT(problem_of("mode: geometric\naxes: {m: {field: geometric.measured, values: [a.json]}}\n"),
              HasSubstr("is no field that can be varied"));
}

TEST(SweepConfig, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(problem_of("axes: {l: {field: odometry.lambda, values: []}}\n"),
              HasSubstr("axes.l.values: a list of 0: must be a list of one value or more"));
  EXPECT_THAT(
      problem_of("axes:\n  a:\n    field: odometry.lamda\n    values: [1]\n"),
      AllOf(HasSubstr("trial.yaml:3"), HasSubstr("odometry.lamda"), HasSubstr("did you mean \"odometry.lambda\"")));
  EXPECT_THAT(problem_of("axes:\n  a: {field: lambda, values: [1]}\n"), HasSubstr("did you mean \"odometry.lambda\""));
  EXPECT_THAT(problem_of("axes:\n  a: {field: odometry.lambda, values: [1,\n -3]}\n"),
              AllOf(HasSubstr("trial.yaml:3"), HasSubstr("odometry.lambda"), HasSubstr("-3"), HasSubstr("0 to 1000")));
  EXPECT_THAT(problem_of("run: {pose: 3}\n"), AllOf(HasSubstr("run.pose"), HasSubstr("did you mean \"poses\"")));
  EXPECT_THAT(problem_of("axes: {a: {field: poses, values: [3]}, b: {field: poses, values: [4]}}\n"),
              HasSubstr("poses is set by axis b and by axis a"));
  EXPECT_THAT(problem_of("axes: {a: {field: seed, values: [3]}}\nseeds: 2\n"), HasSubstr("and by the seeds"));
  EXPECT_THAT(problem_of("axes: {a: {field: poses, values: [3, 3]}}\n"), HasSubstr("two levels have this label"));
  EXPECT_THAT(problem_of("axes: {a: {field: poses}}\n"), HasSubstr("needs one of values, range, link, points"));
  EXPECT_THAT(problem_of("axes: {a: {field: poses, range: {from: 1, to: 5}}}\n"), HasSubstr("a step or a count"));
  EXPECT_THAT(problem_of("axes: {a: {link: {poses: [1, 2], seed: [1]}}}\n"),
              HasSubstr("as long as those of the other"));
  EXPECT_THAT(problem_of("axes: {method: {field: poses, values: [3]}}\n"), HasSubstr("no other column's"));
  EXPECT_THAT(problem_of("axes: {a: {field: images, values: [101]}}\n"), HasSubstr("at most the run's poses, 100"));
  EXPECT_THAT(problem_of("seeds: {count: 3, field: sed}\n"), HasSubstr("did you mean \"seed\""));
  EXPECT_THAT(problem_of("run: {scenes: [indoor_lab]}\n"), HasSubstr("by an axis"));
  EXPECT_THAT(problem_of("geometric: {ground: false}\n"), HasSubstr("belongs to mode: geometric"));
  EXPECT_THAT(problem_of("mode: geometric\naxes: {a: {field: scene, values: [indoor_lab]}}\n"),
              HasSubstr("has no effect in mode geometric"));
  EXPECT_THAT(problem_of("methods: [ml]\nreference: li\n"), HasSubstr("must be one of the methods"));
  EXPECT_THAT(problem_of("axis: {}\n"), HasSubstr("did you mean \"axes\""));
  // Everything at once.
  EXPECT_THAT(problem_of("mode: odd\nseeds: -1\nmethods: []\n"),
              AllOf(HasSubstr("mode"), HasSubstr("seeds"), HasSubstr("methods")));
}

}  // namespace
}  // namespace rigproof
