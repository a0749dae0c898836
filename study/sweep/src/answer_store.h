// The finished answers of a sweep's folder: a file each while the tasks of a pack are worked on
// (tasks/TASK/METHOD.json), and all answers of so many tasks in one file afterwards (packs/NAME.jsonl). Neither needs a
// lock: both appear whole or not at all, any process may write the same one again, and files are removed only once a
// pack holds them.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "answer.h"
#include "folder.h"

namespace rigproof {

/// A distinct task of a sweep.
struct WorkItem {
  const SweepTask* task = nullptr;
  std::size_t repeats = 1;  ///< tasks of its key
};

/// In the order in which they are worked on: those that share pictures together.
std::vector<WorkItem> work_order(const std::vector<SweepTask>& tasks);

/// Places in the work order whose answers are packed together: [first, last).
struct PackRange {
  std::size_t first = 0, last = 0;
};
PackRange pack_of(std::size_t place, const std::vector<WorkItem>& order);

/// What is known of an answer without its figures.
struct AnswerBrief {
  SweepStatus status = SweepStatus::kFailed;
  std::vector<Finding> reasons;
  SweepMachine machine;
};

/// What stands in a folder at the moment of its construction, of the methods that were planned.
class AnswerStore {
 public:
  AnswerStore(SweepFolder folder, const SweepPlan& plan);

  /// Nothing if there is none, a damaged one, or that of another program or description.
  std::optional<SweepAnswer> load(const std::string& task, std::size_t method) const;
  std::optional<AnswerBrief> brief(const std::string& task, std::size_t method) const;
  bool has_single(const std::string& task) const { return singles_.count(task) > 0; }
  /// Packs the answers of these tasks if all are there by now, and removes their files.
  void pack_if_complete(const std::vector<WorkItem>& order, const PackRange& range) const;

 private:
  struct Place {
    std::size_t pack = 0;
    std::uint64_t offset = 0, bytes = 0;
    std::size_t brief = 0;
  };

  void list_pack(const std::filesystem::path& file);
  std::optional<SweepAnswer> load_single(const std::string& task, std::size_t method) const;
  std::optional<SweepAnswer> load_packed(const std::string& task, std::size_t method) const;

  SweepFolder folder_;
  const SweepPlan& plan_;
  std::unordered_set<std::string> singles_;  ///< tasks that have files of their own
  std::vector<std::filesystem::path> packs_;
  std::vector<AnswerBrief> briefs_;
  std::vector<std::unordered_map<std::string, Place>> places_;  ///< by method, then task
};

}  // namespace rigproof
