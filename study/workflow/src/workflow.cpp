#include "rigproof/study/workflow/workflow.h"

#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/folders.h"
#include "rigproof/validate/proof.h"

namespace rigproof {

Observations observations_of(const Input& input, const ObserveOptions& options) {
  if (input.observations) return *input.observations;
  return observe(input.recording.value(), options);
}

std::filesystem::path product_folder(const Input& input) {
  std::error_code ignored;
  const bool is_file = input.is_bare_observations() && !std::filesystem::is_directory(input.path, ignored);
  return is_file ? std::filesystem::absolute(input.path).parent_path() : input.path;
}

std::optional<Truth> truth_beside(const Input& input) {
  if (!input.run || !std::filesystem::is_regular_file(input.run->truth_file())) return std::nullopt;
  return load_truth(input.run->truth_file());
}

std::vector<std::filesystem::path> result_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : folder_entries(folder))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  return files;
}

std::vector<Result> load_results(const std::filesystem::path& folder) {
  std::vector<Result> results;
  for (const auto& file : result_files(folder)) results.push_back(load_result(file));
  return results;
}

std::optional<std::size_t> find_result(const std::vector<Result>& results, const std::string& method) {
  std::vector<std::size_t> with_settings;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (results[i].method == (method.empty() ? "ml" : method)) return i;
    if (method.empty() && results[i].method.rfind("ml-", 0) == 0) with_settings.push_back(i);
  }
  if (with_settings.size() != 1) return std::nullopt;
  return with_settings.front();
}

Budget budget_of(const std::filesystem::path& file) {
  if (file.empty()) return default_budget();
  return load_budget(find_config_file("budgets", file.string()));
}

Verdict judge(const Result& result, const Truth& truth, const Budget& budget, const std::string& file) {
  Verdict verdict;
  verdict.comparison = compare(result, truth, file);
  verdict.gate = apply_budget(verdict.comparison, budget);
  if (budget.nothing_suspected) add_suspicions(result.notes, &verdict.gate);
  return verdict;
}

Proof prove_run(const RunFolder& run, const Input& input, const Observations& observations, const Wording& wording) {
  const Proof proof = prove(input.recording.value(), observations, load_truth(run.truth_file()));
  try {
    save_proof(proof, run.proof_file(), wording);
  } catch (const Error&) {
    // A run on a read-only medium can be proved, too.
  }
  return proof;
}

}  // namespace rigproof
