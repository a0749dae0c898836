// Every shipped sweep reads, and every task of it is a configuration that can be run.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "paths.h"
#include "rigproof/core/error.h"
#include "rigproof/study/report/paper.h"
#include "rigproof/study/sweep/config.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

const fs::path kConfig = source_path("config");

std::vector<SweepTask> plan_of(const fs::path& file) { return plan_sweep(load_sweep_config(file)); }

TEST(PaperConfigs, MakeTheTasksOfTheirExperiments) {
  const std::vector<std::pair<std::string, std::size_t>> tasks = {
      {"table1", 2 * 10}, {"quantity", 10 * 10}, {"odometry", 2 * 11 * 20}, {"table3", 10}, {"why", 10 * 20}};
  ASSERT_EQ(tasks.size(), paper_experiments().size());
  for (const auto& [name, count] : tasks) {
    EXPECT_EQ(plan_of(kConfig / (find_paper_experiment(name).config + ".yaml")).size(), count) << name;
  }
}

// 440 tasks differ in odometry alone, and 100 in the number of stops: one set of pictures, and ten.
TEST(PaperConfigs, RenderOnceWhatCanBeShared) {
  const auto keys = [](const char* name) {
    std::set<std::string> all;
    for (const SweepTask& task : plan_of(kConfig / "paper" / name)) all.insert(task.pictures);
    return all;
  };
  EXPECT_EQ(keys("odometry.yaml").size(), 1U);
  EXPECT_EQ(keys("quantity.yaml").size(), 10U);
  EXPECT_EQ(keys("why.yaml"), keys("quantity.yaml"));
}

TEST(StressConfigs, VaryOneThing) {
  std::size_t sweeps = 0;
  for (const auto& entry : fs::directory_iterator(kConfig / "stress")) {
    if (entry.path().filename() == "base.yaml") continue;
    const SweepConfig config = load_sweep_config(entry.path());
    ++sweeps;
    EXPECT_EQ(config.name, "stress_" + entry.path().stem().string());
    ASSERT_EQ(config.axes.size(), 1U) << entry.path();
    EXPECT_GE(config.axes[0].levels.size(), 4U) << entry.path();
    EXPECT_EQ(plan_sweep(config).size(), config.axes[0].levels.size() * config.seeds.size());
  }
  EXPECT_EQ(sweeps, 13U);
}

// The sweep over all cases and the cases' own files must not drift apart.
TEST(BenchV1Sweep, PointsAreTheCasesFiles) {
  const SweepConfig config = load_sweep_config(kConfig / "bench-v1/bench-v1.yaml");
  const std::vector<SweepTask> tasks = plan_sweep(config);
  ASSERT_EQ(tasks.size(), 15U * 3U);
  for (const SweepTask& task : tasks) {
    const std::string name = config.axes.at(0).levels.at(task.levels.at(0)).label;
    GenerateConfig published = load_generate_config(kConfig / "bench-v1" / (name + ".yaml"));
    published.seed = task.seed;
    GenerateConfig made = settings_of(config, task).config;
    made.name = published.name;
    EXPECT_TRUE(differences(published, made).empty()) << name << ": " << differences(published, made).front();
  }
}

}  // namespace
}  // namespace rigproof
