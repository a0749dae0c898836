// The summary of made-up rows: nothing that failed is averaged away.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rigproof/study/sweep/rows.h"

namespace rigproof {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

/// Two cameras; errors of tx as the tests say, of all other axes a tenth of it; bound 1 on every axis.
class MadeUpSweep {
 public:
  MadeUpSweep(std::size_t levels, std::size_t seeds, std::vector<std::string> methods) {
    rows_.name = "made up";
    rows_.axes = rows_.axis_titles = {"noise"};
    rows_.pooled = {false};
    rows_.levels.emplace_back();
    rows_.level_values.emplace_back();
    for (std::size_t level = 0; level < levels; ++level) {
      rows_.levels[0].push_back(std::to_string(level));
      rows_.level_values[0].push_back(static_cast<double>(level));
      for (std::size_t seed = 0; seed < seeds; ++seed)
        rows_.tasks.push_back({key(level, seed), {level}, static_cast<std::int64_t>(seed), {}});
    }
    rows_.methods = std::move(methods);
    rows_.reference = rows_.methods.front();
  }

  void solve(std::size_t level, std::size_t seed, const std::string& method, double left, double right) {
    add(level, seed, method, SweepSubject::kRig, "all", SweepStatus::kSolved, "", {});
    add(level, seed, method, SweepSubject::kCamera, "left", SweepStatus::kSolved, "", left);
    add(level, seed, method, SweepSubject::kCamera, "right", SweepStatus::kSolved, "", right);
  }
  void fail(std::size_t level, std::size_t seed, const std::string& method, SweepStatus status,
            const std::string& reason) {
    add(level, seed, method, SweepSubject::kRig, "all", status, reason, {});
    add(level, seed, method, SweepSubject::kCamera, "left", status, reason, {});
    add(level, seed, method, SweepSubject::kCamera, "right", status, reason, {});
  }

  SweepSummary summary() const { return summarise(rows_); }
  SweepRows& rows() { return rows_; }

 private:
  static std::string key(std::size_t level, std::size_t seed) {
    return "a" + std::to_string(level) + "b" + std::to_string(seed);
  }

  void add(std::size_t level, std::size_t seed, const std::string& method, SweepSubject subject,
           const std::string& camera, SweepStatus status, const std::string& reason, std::optional<double> tx) {
    SweepRow row;
    row.task = key(level, seed);
    row.levels = {std::to_string(level)};
    row.seed = static_cast<std::int64_t>(seed);
    row.method = method;
    row.subject = subject;
    row.camera = camera;
    row.status = status;
    if (!reason.empty()) row.reasons = {stated(reason, Severity::kRefusal)};
    if (tx) {
      row.error.fill(0.1 * *tx);
      row.error[0] = tx;
      row.bound.fill(1.0);
    }
    rows_.rows.push_back(row);
  }

  SweepRows rows_;
};

const SummaryRow& find(const SweepSummary& summary, const std::string& level, const std::string& method,
                       SummaryAxis axis = SummaryAxis::kTx, SweepSubject subject = SweepSubject::kCamera) {
  for (const SummaryRow& row : summary.rows)
    if (row.levels[0] == level && row.method == method && row.axis == axis && row.subject == subject) return row;
  throw std::runtime_error("no such row");
}

TEST(SweepSummary, FiguresOfOneSample) {
  MadeUpSweep sweep(1, 2, {"ml"});
  sweep.solve(0, 0, "ml", 1.0, -2.0);
  sweep.solve(0, 1, "ml", 3.0, -4.0);
  const SweepSummary summary = sweep.summary();
  const SummaryRow& row = find(summary, "0", "ml");
  EXPECT_DOUBLE_EQ(row.success_rate, 1.0);
  EXPECT_EQ(row.all.count, 4);
  EXPECT_DOUBLE_EQ(*row.all.mean, -0.5);
  EXPECT_DOUBLE_EQ(*row.all.mean_absolute, 2.5);
  EXPECT_DOUBLE_EQ(*row.all.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(*row.all.rmse_over_bound, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(*row.all.quantiles[2], 2.5);
  EXPECT_DOUBLE_EQ(*row.all.largest, 4.0);
  EXPECT_NEAR(*row.all.deviation, std::sqrt((2.25 + 2.25 + 12.25 + 12.25) / 3.0), 1e-12);
  EXPECT_NEAR(*find(summary, "0", "ml", SummaryAxis::kTranslation).all.mean_absolute, 2.5 * std::sqrt(1.02), 1e-12);
  EXPECT_EQ(find(summary, "0", "ml", SummaryAxis::kYaw).all.count, 0) << "no angles were given";
}

TEST(SweepSummary, FailuresAreCountedAndNamed) {
  MadeUpSweep sweep(1, 4, {"ml", "theirs"});
  for (std::size_t seed = 0; seed < 4; ++seed) sweep.solve(0, seed, "ml", seed == 3 ? 90.0 : 1.0, 1.0);
  sweep.solve(0, 0, "theirs", 0.5, 0.5);
  sweep.fail(0, 1, "theirs", SweepStatus::kRefused, "no turn");
  sweep.fail(0, 2, "theirs", SweepStatus::kFailed, "crashed");
  const SweepSummary summary = sweep.summary();
  const SummaryRow& theirs = find(summary, "0", "theirs");
  EXPECT_EQ(theirs.tasks, 4);
  EXPECT_EQ(theirs.answered, 1);
  EXPECT_EQ(theirs.solved, 1);
  EXPECT_EQ(theirs.refused, 1);
  EXPECT_EQ(theirs.failed, 1);
  EXPECT_EQ(theirs.missing, 1);
  EXPECT_DOUBLE_EQ(theirs.success_rate, 0.25);
  EXPECT_EQ(theirs.all.count, 2);
  // What ml makes of the task that theirs solved stands beside what it makes of all.
  const SummaryRow& ml = find(summary, "0", "ml");
  EXPECT_GT(*ml.all.mean_absolute, 10.0);
  EXPECT_DOUBLE_EQ(*ml.common.mean_absolute, 1.0);
  EXPECT_EQ(ml.common.count, 2);
  ASSERT_EQ(summary.failures.size(), 2U);
  EXPECT_EQ(summary.failures[0].method, "theirs");
  const std::string text = format_summary(summary);
  EXPECT_THAT(text, HasSubstr("1/3")) << "what is not run has not failed";
  EXPECT_THAT(text, HasSubstr("Not everything is run: success is of the tasks that are"));
  EXPECT_THAT(text, HasSubstr("1 x theirs failed: crashed"));
  EXPECT_THAT(summary_as_markdown(summary), HasSubstr("- 1 x theirs refused: no turn"));
}

TEST(SweepSummary, WhatIsNotRunIsNoSuccessAndNoFailure) {
  MadeUpSweep sweep(2, 2, {"ml"});
  for (std::size_t seed = 0; seed < 2; ++seed) sweep.solve(0, seed, "ml", 1.0, 1.0);
  const std::string text = format_summary(sweep.summary());
  EXPECT_THAT(text, ContainsRegex("\n 0 +ml +2/2 +1\\.0"));
  EXPECT_THAT(text, ContainsRegex("\n 1 +ml +- +- "));
  EXPECT_THAT(text, Not(HasSubstr("0/2")));
  for (std::size_t seed = 0; seed < 2; ++seed) sweep.solve(1, seed, "ml", 1.0, 1.0);
  EXPECT_THAT(format_summary(sweep.summary()), Not(HasSubstr("Not everything is run")));
}

TEST(SweepSummary, AReasonThatStandsForSeveralTasksIsAnExample) {
  MadeUpSweep sweep(1, 3, {"ml"});
  sweep.fail(0, 0, "ml", SweepStatus::kRefused, "no turn");
  sweep.fail(0, 1, "ml", SweepStatus::kRefused, "no turn");
  sweep.fail(0, 2, "ml", SweepStatus::kFailed, "crashed");
  const std::string text = format_summary(sweep.summary());
  EXPECT_THAT(text, HasSubstr("2 x ml refused, for example: no turn"));
  EXPECT_THAT(text, HasSubstr("1 x ml failed: crashed"));
}

TEST(SweepSummary, AnAnswerFarOffIsNone) {
  MadeUpSweep sweep(1, 3, {"ml", "astray"});
  for (std::size_t seed = 0; seed < 3; ++seed) sweep.solve(0, seed, "ml", 1.0, 1.0);
  sweep.solve(0, 0, "astray", 2.0, 2.0);
  sweep.solve(0, 1, "astray", 2.0, 101.0);
  sweep.solve(0, 2, "astray", 2.0, 2.0);
  // A metre and 20 degrees are limits of lengths, in all three axes: a turn of 13 degrees about each is too much.
  for (std::size_t i = 3; i < 6; ++i) sweep.rows().rows.back().error[i] = 13.0;
  EXPECT_TRUE(is_far(sweep.rows().rows.back()));
  const SweepSummary summary = sweep.summary();
  for (const SummaryAxis axis : {SummaryAxis::kTx, SummaryAxis::kRz, SummaryAxis::kTranslation}) {
    const SummaryRow& row = find(summary, "0", "astray", axis);
    EXPECT_EQ(row.answered, 1);
    EXPECT_EQ(row.far, 2);
    EXPECT_EQ(row.all.count, 4) << "what is not far is counted, in tasks that have a far one, too";
    EXPECT_EQ(row.common.count, 2);
    EXPECT_EQ(row.against_reference.count, 1);
    EXPECT_EQ(row.solved, 3) << "the method believes that it solved all";
  }
  EXPECT_DOUBLE_EQ(*find(summary, "0", "astray").all.largest, 2.0);
  EXPECT_EQ(find(summary, "0", "ml").far, 0);
  const std::string text = format_summary(summary);
  EXPECT_THAT(text, HasSubstr("1/3"));
  EXPECT_THAT(text, HasSubstr("More than 1 m or 20 deg off, counted as no answer: astray 2 cameras.\n"));
  EXPECT_THAT(summary_as_markdown(summary), HasSubstr("astray 2 cameras"));
}

// A camera that never sees the board still sees the ground: its height and tilt are no success in x.
TEST(SweepSummary, AnAxisOfOneCameraIsAskedOfAll) {
  MadeUpSweep sweep(1, 2, {"ml"});
  for (std::size_t seed = 0; seed < 2; ++seed) {
    sweep.solve(0, seed, "ml", 1.0, 1.0);
    sweep.rows().rows.back().error[0].reset();
  }
  EXPECT_EQ(find(sweep.summary(), "0", "ml").all.count, 2);
  EXPECT_THAT(format_summary(sweep.summary()), HasSubstr("0/2"));
  for (SweepRow& row : sweep.rows().rows) row.error[0].reset();
  EXPECT_THAT(format_summary(sweep.summary()), HasSubstr("2/2")) << "an axis that is never given is not asked";
}

TEST(SweepSummary, FailuresOfOneFindingAreOneKindWhateverTheirValues) {
  MadeUpSweep sweep(1, 3, {"ml"});
  for (std::size_t seed = 0; seed < 3; ++seed)
    sweep.fail(0, seed, "ml", SweepStatus::kRefused, std::string(seed + 1, 'x') + " views");
  std::vector<SweepRow>& rows = sweep.rows().rows;
  EXPECT_EQ(count_failures(rows).size(), 3U) << "somebody else's sentences are all that is known";
  for (SweepRow& row : rows) row.reasons = {row.reasons.front().with({{"code", "image.dark"}})};
  EXPECT_EQ(count_failures(rows).size(), 1U) << "of a folder of before";
  for (SweepRow& row : rows) row.reasons = {Finding("method.one_board", {{"boards", row.seed + 2}})};
  const std::vector<FailureCount> failures = count_failures(rows);
  ASSERT_EQ(failures.size(), 1U);
  EXPECT_EQ(failures[0].tasks, 3);
  EXPECT_EQ(code_of(failures[0].reasons), "method.one_board");
  EXPECT_THAT(format_summary(sweep.summary()), HasSubstr("3 x ml refused, for example: The recording has 2 boards"));
}

TEST(SweepSummary, AMethodThatNeverAnswersAnAxisDoesNotEmptyTheCommonTasks) {
  MadeUpSweep sweep(1, 2, {"ml", "li"});
  for (std::size_t seed = 0; seed < 2; ++seed) {
    sweep.solve(0, seed, "ml", 1.0, 1.0);
    sweep.fail(0, seed, "li", SweepStatus::kSolved, "");  // pairs only: its cameras have no errors
  }
  const SweepSummary summary = sweep.summary();
  EXPECT_EQ(find(summary, "0", "ml").common.count, 4);
  EXPECT_EQ(find(summary, "0", "li").answered, 0);
  EXPECT_EQ(find(summary, "0", "li").solved, 2);
}

TEST(SweepSummary, TestsAgainstTheReferenceTaskByTask) {
  MadeUpSweep sweep(2, 12, {"ml", "worse", "same"});
  for (std::size_t seed = 0; seed < 12; ++seed) {
    const double hard = 1.0 + static_cast<double>(seed);  // the tasks differ by much more than the methods
    for (const std::size_t level : {std::size_t{0}, std::size_t{1}}) {
      sweep.solve(level, seed, "ml", hard, -hard);
      sweep.solve(level, seed, "worse", hard + 0.1, -hard - 0.1);
      const double sign = seed % 2 == 0 ? 1.0 : -1.0;
      sweep.solve(level, seed, "same", hard + 0.1 * sign, hard + 0.1 * sign);
    }
  }
  const SweepSummary summary = sweep.summary();
  const PairedTest& worse = find(summary, "1", "worse").against_reference;
  EXPECT_EQ(worse.count, 12) << "a task counts once, not once a camera";
  EXPECT_NEAR(*worse.difference, 0.1, 1e-12);
  EXPECT_NEAR(*worse.p, 2.0 / 4096.0, 1e-12);
  EXPECT_GT(*worse.p_holm, *worse.p);
  EXPECT_GT(*worse.interval_low, 0.0);
  const PairedTest& same = find(summary, "1", "same").against_reference;
  EXPECT_GT(*same.p, 0.5);
  EXPECT_LT(*same.interval_low, 0.0);
  EXPECT_GT(*same.interval_high, 0.0);
  EXPECT_FALSE(find(summary, "1", "ml").against_reference.p.has_value());
}

TEST(SweepSummary, PooledLevelsAreRepetitions) {
  MadeUpSweep sweep(3, 1, {"ml"});
  for (const std::size_t level : {std::size_t{0}, std::size_t{1}, std::size_t{2}})
    sweep.solve(level, 0, "ml", static_cast<double>(level), static_cast<double>(level));
  sweep.rows().pooled = {true};
  const SweepSummary summary = sweep.summary();
  const SummaryRow& row = find(summary, "all", "ml");
  EXPECT_EQ(row.tasks, 3);
  EXPECT_DOUBLE_EQ(*row.all.mean_absolute, 1.0);
}

TEST(SweepSummary, TablesHaveTheColumnsThatAreDocumented) {
  MadeUpSweep sweep(1, 1, {"ml"});
  sweep.solve(0, 0, "ml", 1.0, 1.0);
  const std::string csv = summary_as_csv(sweep.summary());
  EXPECT_EQ(
      csv.substr(0, csv.find('\n')),
      "noise,method,subject,axis,unit,success_rate,tasks,answered,far,solved,partial,refused,could_not_run,failed,"
      "missing,n,mean_abs,std_abs,mean,std,q05,q25,median,q75,q95,max,rmse,rmse_over_bound,common_n,"
      "common_mean_abs,common_std_abs,common_mean,common_std,common_q05,common_q25,common_median,common_q75,"
      "common_q95,common_max,common_rmse,common_rmse_over_bound,pair_n,pair_difference,pair_low,pair_high,pair_p,"
      "pair_p_holm");
  EXPECT_THAT(csv, HasSubstr("\n0,ml,camera,tx,cm,1,1,1,0,1,0,0,0,0,0,2,1,0,1,0,1,1,1,1,1,1,1,1,2,1,"));
}

}  // namespace
}  // namespace rigproof
