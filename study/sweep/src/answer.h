// One finished (task, method) as text.
#pragma once

#include <nlohmann/json_fwd.hpp>
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
  SweepMachine machine;
};

/// A line.
std::string text_of(const SweepAnswer& answer);
/// Nothing where the text is damaged.
std::optional<SweepAnswer> read_answer(const std::string& text);

/// What both texts of answers and lists of them hold. Throw std::exception at anything else.
SweepStatus sweep_status_of(int number);
nlohmann::json json_of(const SweepMachine& machine);
nlohmann::json reasons_json(const std::vector<Finding>& reasons);
SweepMachine machine_of(const nlohmann::json& list);
std::vector<Finding> reasons_of(const nlohmann::json& list);
/// Of folders that have them in words, with the code of the first one.
std::vector<Finding> reasons_of_before(const std::string& code, const std::string& sentences);

/// Its name and processor.
const SweepMachine& this_machine();

}  // namespace rigproof
