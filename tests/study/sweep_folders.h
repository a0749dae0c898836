// A small sweep without pictures, and the folders that tests run it in.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "rigproof/study/sweep/sweep.h"
#include "temp_folder.h"

namespace rigproof {

inline const char* const kSmall = R"(
mode: geometric
run: {poses: 8}
axes:
  lambda: {field: odometry.lambda, values: [0.5, 2]}
seeds: {count: 2}
methods: [ml, li]
)";

class SweepFolders : public testing::Test {
 protected:
  SweepConfig config(const std::string& text = kSmall) const {
    return load_sweep_config(folder_.write("s.yaml", text));
  }

  SweepOptions options(const std::string& name, int jobs = 2) const {
    SweepOptions options;
    options.folder = folder_ / name;
    options.cache = folder_ / (name + "_cache");
    options.jobs = jobs;
    return options;
  }

  // The tables that must not depend on how they came about.
  std::string tables(const std::string& name) const {
    std::string text;
    for (const char* file : {"rows.csv", "rows.jsonl", "summary.csv", "summary.json", "summary.md"})
      text += folder_.read(name + "/" + file);
    return text;
  }

  TempFolder folder_;
};

}  // namespace rigproof
