#include "comments.h"

#include <algorithm>

#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "tree_frames.h"

namespace rigproof::exporting {

constexpr std::size_t kLongest = 1000;

std::vector<std::string> head_lines(const ExportJob& job) {
  std::string line = "rigproof " + std::string(version()) + " export";
  if (!job.date.empty()) line += ", " + job.date;
  if (!job.result_file.empty()) line += ", of " + for_message(job.result_file, 200);
  line += " (method " + for_message(job.method) + ", " + result_status_name(job.status) + ")";
  std::vector<std::string> lines = {line};
  for (const std::string& remark : remarks_of(job)) lines.push_back(for_message(remark, kLongest));
  return lines;
}

std::vector<std::string> tree_head_lines(const ExportJob& job) {
  std::vector<std::string> lines = head_lines(job);
  for (const std::string& note : tree_notes(job)) lines.push_back(for_message(note, kLongest));
  return lines;
}

std::string hash_comment(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "# " + line + "\n";
  return text;
}

std::string xml_comment(const std::vector<std::string>& lines, const std::string& indent) {
  std::string inside;
  for (const std::string& line : lines) inside += (inside.empty() ? "" : "\n" + indent + "     ") + line;
  // Two hyphens end a comment, or are an error in it.
  for (std::size_t at = inside.find("--"); at != std::string::npos; at = inside.find("--", at))
    inside.insert(at + 1, " ");
  return indent + "<!-- " + inside + " -->\n";
}

std::string xml_attribute(const std::string& text) {
  std::string escaped;
  for (const char c : text) switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  return escaped;
}

std::string identifier(const std::string& name) {
  std::string text = name;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  std::replace_if(
      text.begin(), text.end(), [&](char c) { return !is_letter(c) && !(c >= '0' && c <= '9'); }, '_');
  return text.empty() || !is_letter(text.front()) ? "_" + text : text;
}

}  // namespace rigproof::exporting
