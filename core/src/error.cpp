#include "rigproof/core/error.h"

#include <algorithm>
#include <tuple>

namespace rigproof {

std::string Problem::text() const {
  std::string text = file;
  if (line > 0) text += (text.empty() ? "line " : ":") + std::to_string(line);
  for (const std::string& part : {field, value, message}) {
    if (part.empty()) continue;
    if (!text.empty()) text += ": ";
    text += part;
  }
  return text;
}

void Problems::append(const Problems& other) {
  problems_.insert(problems_.end(), other.problems_.begin(), other.problems_.end());
}

void Problems::sort() {
  std::stable_sort(problems_.begin(), problems_.end(), [](const Problem& a, const Problem& b) {
    return std::tie(a.file, a.line) < std::tie(b.file, b.line);
  });
}

std::string Problems::text() const {
  // A file that is wrong throughout must not push the first problem off the screen.
  constexpr std::size_t kMost = 40;
  std::string text;
  for (std::size_t i = 0; i < problems_.size() && i < kMost; ++i) text += (i == 0 ? "" : "\n") + problems_[i].text();
  if (problems_.size() > kMost) text += "\nand " + std::to_string(problems_.size() - kMost) + " more problems";
  return text;
}

void Problems::throw_if_any() const {
  if (!problems_.empty()) throw Error(text());
}

}  // namespace rigproof
