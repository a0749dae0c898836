// Whole workflows out of the parts: what several commands do the same way.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/calib/vision/observe.h"
#include "rigproof/core/result.h"
#include "rigproof/formats/format.h"
#include "rigproof/truth/truth.h"
#include "rigproof/validate/budget.h"
#include "rigproof/validate/proof.h"
#include "rigproof/validate/validate.h"

namespace rigproof {

/// The observations of an input: read where they are the input, made from the images otherwise.
Observations observations_of(const Input& input, const ObserveOptions& options);

/// Folder in which the products of an input go (results/, pictures/, observations.json): the run's, the recording's,
/// or the one that holds the observations.
std::filesystem::path product_folder(const Input& input);

/// The truth of a run; absent for any other input.
std::optional<Truth> truth_beside(const Input& input);

/// The result files (*.yaml) of a folder, sorted by name; none if there is no such folder.
std::vector<std::filesystem::path> result_files(const std::filesystem::path& folder);
/// Every result in a folder, in the order of their names. Throws Error if one of them cannot be read.
std::vector<Result> load_results(const std::filesystem::path& folder);
/// Index of the result of a method; for an empty name that of ml, else the only one of ml with settings
/// (name_with_settings()). Nothing if it is not there.
std::optional<std::size_t> find_result(const std::vector<Result>& results, const std::string& method);

/// A budget by file or by the name of a shipped one ("ci"); the default one for an empty path.
Budget budget_of(const std::filesystem::path& file);

/// A result judged against the truth.
struct Verdict {
  Comparison comparison;
  Gate gate;
};
/// Against the truth, and against what the result says of itself where the budget asks for it. Throws as compare().
Verdict judge(const Result& result, const Truth& truth, const Budget& budget, const std::string& file = {});

/// Proves the conventions of a run from its observations and its truth; writes truth/proof.yaml where it may.
/// Throws Error if the run has no truth.
Proof prove_run(const RunFolder& run, const Input& input, const Observations& observations, const Wording& wording);

}  // namespace rigproof
