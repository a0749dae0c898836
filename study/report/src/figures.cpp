#include "rigproof/study/report/figures.h"

#include <sstream>

#include "rigproof/core/child_process.h"
#include "rigproof/core/data_path.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr double kTimeLimitS = 600.0;

// What a script said into a file that is of no further use.
std::string take_text(const fs::path& file) {
  std::error_code ignored;
  const std::string text = fs::exists(file, ignored) ? read_text_file(file) : std::string();
  fs::remove(file, ignored);
  return text;
}

std::string command_line(std::vector<std::string> words) {
  for (std::string& word : words) word = shell_word(word);
  return joined(words, " ");
}

}  // namespace

std::vector<fs::path> draw_figures(const std::string& kind, const fs::path& csv,
                                   const std::vector<std::string>& options) {
  std::vector<std::string> words = {"python3", (data_folder() / "figures" / "plot.py").string(), kind,
                                    fs::absolute(csv).string()};
  words.insert(words.end(), options.begin(), options.end());
  const fs::path drawn = csv.string() + ".drawn", said = csv.string() + ".said";
  const ProgramReport report = run_program({words, ".", drawn, said, kTimeLimitS, nullptr});
  std::istringstream lines(take_text(drawn));
  std::string reason = take_text(said);
  if (!report.failure.empty()) {
    if (reason.empty())
      reason = "python3 " + report.failure + "; figures need it: apt-get install python3 python3-matplotlib\n";
    throw Error(csv.string() + " is written, its figures are not: " + reason +
                "Then draw them by: " + command_line(words));
  }
  std::vector<fs::path> files;
  for (std::string line; std::getline(lines, line);) files.emplace_back(line);
  return files;
}

}  // namespace rigproof
