#include "rigproof/validate/integrity.h"

#include <algorithm>
#include <array>
#include <optional>

#include "rigproof/core/error.h"
#include "rigproof/core/figures.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using Kind = IntegrityProblem::Kind;

const char* kind_name(Kind kind) {
  static constexpr std::array<const char*, 5> kNames = {"missing", "altered", "extra", "unreadable", "unfinished"};
  return kNames[static_cast<std::size_t>(kind)];
}

// "12,345": sizes are compared digit by digit.
std::string grouped(std::uint64_t value) {
  std::string text = std::to_string(value);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, ",");
  return text;
}

std::string size_message(std::uint64_t size, std::uint64_t expected) {
  const std::string what = size == 0 ? "empty" : size < expected ? "truncated or replaced" : "altered";
  return what + ": " + grouped(size) + " bytes, " + grouped(expected) + " in the manifest";
}

// Nothing where the file is as the manifest has it. What is read is added to `bytes`.
std::optional<IntegrityProblem> problem_of(const RunFolder& run, const std::string& file, const FileEntry& entry,
                                           std::uint64_t* bytes) {
  try {
    const fs::path path = path_inside(run.root, file);
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) return IntegrityProblem{Kind::kMissing, file, "missing"};
    if (!fs::is_regular_file(status)) return IntegrityProblem{Kind::kAltered, file, "altered: no longer a file"};
    const std::uintmax_t size = fs::file_size(path);
    if (size != entry.size_bytes) return IntegrityProblem{Kind::kAltered, file, size_message(size, entry.size_bytes)};
    *bytes += size;
    if (sha256_hex_of_file(path) != entry.sha256)
      return IntegrityProblem{Kind::kAltered, file, "altered: same size, other content (SHA-256 differs)"};
    return std::nullopt;
  } catch (const Error& error) {
    return IntegrityProblem{Kind::kUnreadable, file, error.what()};
  } catch (const fs::filesystem_error& error) {
    return IntegrityProblem{Kind::kUnreadable, file, error.what()};
  }
}

std::vector<IntegrityProblem> extras(const RunFolder& run, const Manifest& manifest, const fs::path& folder) {
  std::vector<IntegrityProblem> problems;
  std::error_code ignored;
  for (const fs::directory_entry& entry : folder_tree(folder)) {
    if (entry.is_directory(ignored) && !entry.is_symlink(ignored)) continue;
    const std::string file = entry.path().lexically_relative(run.root).generic_string();
    if (entry.path() == run.proof_file() || manifest.files.count(file) > 0) continue;
    problems.push_back({Kind::kExtra, file, "extra: not in the manifest"});
  }
  return problems;
}

}  // namespace

std::string IntegrityProblem::text() const { return (file.empty() ? "" : file + ": ") + message; }

std::string IntegrityReport::text() const {
  const std::string amount = grouped(files) + " files, " + short_figure(static_cast<double>(bytes) / 1e6) + " MB";
  if (intact()) return amount + ": all as generated\n";
  std::string text;
  constexpr std::size_t kShown = 5;
  std::array<std::size_t, 5> counts{};
  for (const IntegrityProblem& problem : problems)
    if (++counts[static_cast<std::size_t>(problem.kind)] <= kShown) text += " " + problem.text() + "\n";
  std::string summary;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0)
      summary += (summary.empty() ? "" : ", ") + std::to_string(counts[i]) + " " + kind_name(static_cast<Kind>(i));
  return grouped(files) + " files in the manifest: " + summary + "\n" + text;
}

IntegrityReport verify_manifest(const RunFolder& run) {
  const Manifest manifest = load_manifest(run.manifest_file());
  IntegrityReport report;
  report.files = manifest.files.size();
  report.gl_renderer = manifest.gl_renderer;
  report.tool_version = manifest.tool_version;
  if (!manifest.complete)
    report.problems.push_back({Kind::kUnfinished, "", "the run is not complete: generate resumes it"});
  for (const auto& [file, entry] : manifest.files) {
    std::optional<IntegrityProblem> problem = problem_of(run, file, entry, &report.bytes);
    if (problem) report.problems.push_back(std::move(*problem));
  }
  for (const fs::path& folder : {run.recording(), run.truth()})
    for (IntegrityProblem& extra : extras(run, manifest, folder)) report.problems.push_back(std::move(extra));
  std::stable_sort(report.problems.begin(), report.problems.end(),
                   [](const IntegrityProblem& a, const IntegrityProblem& b) { return a.file < b.file; });
  return report;
}

}  // namespace rigproof
