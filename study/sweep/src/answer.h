// One finished (task, method) on disk: tasks/TASK/METHOD.json in a sweep's folder.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rigproof/study/sweep/rows.h"

namespace rigproof {

struct AnswerTimes {
  double solve_s = 0.0;    ///< wall clock
  double cpu_s = 0.0;      ///< of the process while it solved
  double observe_s = 0.0;  ///< of putting the observations together, shared by the methods of a task
};

struct SweepAnswer {
  std::string method_hash;     ///< of a method from outside or of the program: another one is another answer
  std::vector<SweepRow> rows;  ///< without levels and seed, which are the task's
  AnswerTimes times;
};

std::string text_of(const SweepAnswer& answer);
/// Nothing where the text is damaged.
std::optional<SweepAnswer> read_answer(const std::string& text);

}  // namespace rigproof
