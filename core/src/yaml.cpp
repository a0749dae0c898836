#include "rigproof/core/yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <unordered_set>

#include "rigproof/core/files.h"

namespace rigproof {
namespace {

// Bounds for hostile files. A file without aliases has fewer nodes than bytes; an alias bomb has more.
constexpr int kMaxDepth = 32;
constexpr std::size_t kNodesBeyondBytes = 1000;
// So many unknown keys of one block are reported.
constexpr int kMaxUnknownKeys = 20;

class Converter {
 public:
  Converter(std::string file, std::size_t bytes) : file_(std::move(file)), max_nodes_(bytes + kNodesBeyondBytes) {}

  YamlTree convert(const YAML::Node& node, int depth) {
    YamlTree tree;
    tree.file = file_;
    tree.line = node.Mark().line + 1;
    if (depth > kMaxDepth) fail(tree.line, "nested deeper than " + std::to_string(kMaxDepth) + " levels");
    if (++nodes_ > max_nodes_) fail(tree.line, "aliases expand to more values than the file has bytes");
    if (node.IsScalar()) {
      tree.kind = YamlTree::Kind::kScalar;
      tree.scalar = node.Scalar();
      tree.quoted = node.Tag() == "!" || node.Tag() == "tag:yaml.org,2002:str";
    } else if (node.IsSequence()) {
      tree.kind = YamlTree::Kind::kSequence;
      for (const YAML::Node& item : node) tree.items.push_back(convert(item, depth + 1));
    } else if (node.IsMap()) {
      convert_map(node, depth, &tree);
    }
    return tree;
  }

  [[noreturn]] void fail(int line, const std::string& message) const {
    throw Error(Problem{file_, line, "", "", message}.text());
  }

 private:
  void convert_map(const YAML::Node& node, int depth, YamlTree* tree) {
    tree->kind = YamlTree::Kind::kMap;
    std::unordered_set<std::string> keys;
    for (const auto& entry : node) {
      const int line = entry.first.Mark().line + 1;
      if (!entry.first.IsScalar()) fail(line, "a key must be a word");
      const std::string key = entry.first.Scalar();
      if (!keys.insert(key).second) fail(line, for_message(key) + ": the key is given twice");
      YamlTree value = convert(entry.second, depth + 1);
      value.line = line;
      tree->entries.emplace_back(key, std::move(value));
    }
  }

  std::string file_;
  std::size_t max_nodes_;
  std::size_t nodes_ = 0;
};

// Lines on which documents begin.
class DocumentStarts : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { lines.push_back(mark.line + 1); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {}
  void OnSequenceStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {}
  void OnMapEnd() override {}

  std::vector<int> lines;
};

// YAML::LoadAll never ends on ",a:b": each document ends where it began, before a character that begins nothing.
std::optional<int> line_of_second_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStarts starts;
  while (starts.lines.size() < 2 && parser.HandleNextDocument(starts)) continue;
  if (starts.lines.size() < 2) return std::nullopt;
  return starts.lines[1];
}

bool has_document_marks(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("---", 0) == 0 || line.rfind("...", 0) == 0) return true;
  return false;
}

bool looks_like_number_or_keyword(const std::string& text) {
  static const char* const kKeywords[] = {"true", "false", "yes", "no", "on", "off", "null", "~", "y", "n"};
  constexpr std::size_t kLongestKeyword = 5;
  if (text.size() <= kLongestKeyword) {
    std::string lower = text;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    if (std::find(std::begin(kKeywords), std::end(kKeywords), lower) != std::end(kKeywords)) return true;
  }
  return !text.empty() && (text[0] == '.' || text[0] == '+' || text[0] == '-' || (text[0] >= '0' && text[0] <= '9'));
}

// YAML 1.1 takes "8e-04" for text: a number with an exponent has a point there.
std::string emit_plain(const std::string& text) {
  const std::size_t exponent = text.find('e');
  if (exponent == std::string::npos || text.find('.') != std::string::npos || !parse_number(text)) return text;
  return text.substr(0, exponent) + ".0" + text.substr(exponent);
}

// Text that YAML reads back as the same text without quotes, in block and in flow style.
bool is_plain(const std::string& text) {
  if (text.empty() || looks_like_number_or_keyword(text)) return false;
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.' || c == '/' || c == ' ' || c == '+' || c == '(' || c == ')' || c == ';';
  };
  return std::all_of(text.begin(), text.end(), plain) && text.front() != ' ' && text.back() != ' ' &&
         text.find("---") != 0 && text.find("...") != 0;
}

std::string quoted(const std::string& text) {
  static const char* const kHex = "0123456789abcdef";
  std::string out = "\"";
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto byte = static_cast<unsigned char>(c);
    if (const std::size_t length = utf8_length(text, i); length != 1) {
      out += length == 0 ? "\xEF\xBF\xBD" : text.substr(i, length);  // names of files may be any bytes, YAML may not
      i += std::max<std::size_t>(length, 1) - 1;
    } else if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (byte < 0x20 || byte == 0x7f) {
      out += "\\x";
      out += kHex[byte >> 4U];
      out += kHex[byte & 15U];
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string emit_text(const std::string& text) { return is_plain(text) ? text : quoted(text); }

std::string emit_scalar(const YamlTree& tree) {
  if (tree.is_null()) return "null";
  return tree.quoted ? emit_text(tree.scalar) : emit_plain(tree.scalar);
}

std::string emit_flow(const YamlTree& tree) {
  if (tree.is_sequence()) {
    std::string text = "[";
    for (const YamlTree& item : tree.items) text += (text.size() > 1 ? ", " : "") + emit_flow(item);
    return text + "]";
  }
  if (tree.is_map()) {
    std::string text = "{";
    for (const auto& [key, value] : tree.entries)
      text += (text.size() > 1 ? ", " : "") + emit_text(key) + ": " + emit_flow(value);
    return text + "}";
  }
  return emit_scalar(tree);
}

bool on_one_line(const YamlTree& tree) {
  return tree.flow || tree.is_scalar() || tree.is_null() || (tree.items.empty() && tree.entries.empty());
}

void emit_block(const YamlTree& tree, const std::string& indent, bool first_is_indented, std::string* out) {
  const auto lead = [&](bool first) { return first && first_is_indented ? std::string() : indent; };
  bool first = true;
  for (const YamlTree& item : tree.items) {
    *out += lead(first) + "- ";
    if (on_one_line(item))
      *out += emit_flow(item) + "\n";
    else
      emit_block(item, indent + "  ", true, out);
    first = false;
  }
  for (const auto& [key, value] : tree.entries) {
    *out += lead(first) + emit_text(key) + ":";
    if (on_one_line(value)) {
      *out += " " + emit_flow(value) + "\n";
    } else {
      *out += "\n";
      emit_block(value, indent + "  ", false, out);
    }
    first = false;
  }
}

void add_problem(const YamlTree& tree, const std::string& path, const std::string& message, Problems* problems) {
  problems->add({tree.file, tree.line, path, tree.shown(), message});
}

}  // namespace

const YamlTree* YamlTree::find(const std::string& key) const {
  for (const auto& entry : entries)
    if (entry.first == key) return &entry.second;
  return nullptr;
}

std::string YamlTree::shown() const {
  switch (kind) {
    case Kind::kScalar:
      return scalar.empty() ? "\"\"" : for_message(scalar);
    case Kind::kSequence:
      return "a list of " + std::to_string(items.size());
    case Kind::kMap:
      return "a block";
    case Kind::kNull:
      break;
  }
  return "nothing";
}

YamlTree YamlTree::number(double value) {
  YamlTree tree;
  tree.kind = Kind::kScalar;
  tree.scalar = number_text(value + 0.0);  // -0 says nothing to a reader
  return tree;
}

YamlTree YamlTree::integer(std::int64_t value) {
  YamlTree tree;
  tree.kind = Kind::kScalar;
  tree.scalar = std::to_string(value);
  return tree;
}

YamlTree YamlTree::boolean(bool value) {
  YamlTree tree;
  tree.kind = Kind::kScalar;
  tree.scalar = value ? "true" : "false";
  return tree;
}

YamlTree YamlTree::text(const std::string& value) {
  YamlTree tree;
  tree.kind = Kind::kScalar;
  tree.scalar = value;
  tree.quoted = true;
  return tree;
}

YamlTree YamlTree::numbers(const std::vector<double>& values) {
  YamlTree tree = sequence();
  tree.flow = true;
  for (const double value : values) tree.add(number(value));
  return tree;
}

YamlTree YamlTree::texts(const std::vector<std::string>& values) {
  YamlTree tree = sequence();
  for (const std::string& value : values) tree.add(text(value));
  return tree;
}

YamlTree YamlTree::sequence() {
  YamlTree tree;
  tree.kind = Kind::kSequence;
  return tree;
}

YamlTree YamlTree::map() {
  YamlTree tree;
  tree.kind = Kind::kMap;
  return tree;
}

YamlTree YamlTree::inline_map() {
  YamlTree tree = map();
  tree.flow = true;
  return tree;
}

YamlTree& YamlTree::set(const std::string& key, YamlTree value) {
  entries.emplace_back(key, std::move(value));
  return entries.back().second;
}

YamlTree& YamlTree::add(YamlTree item) {
  items.push_back(std::move(item));
  return items.back();
}

YamlTree parse_yaml(const std::string& text, const std::filesystem::path& file) {
  Converter converter(file.string(), text.size());
  try {
    if (const std::optional<int> line = line_of_second_document(text))
      converter.fail(*line, has_document_marks(text) ? "a second document; only one is allowed"
                                                     : "not valid YAML: text that belongs to nothing before it");
    return converter.convert(YAML::Load(text), 0);
  } catch (const YAML::Exception& error) {
    converter.fail(error.mark.is_null() ? 0 : error.mark.line + 1, "not valid YAML: " + for_message(error.msg));
  }
}

YamlTree read_yaml_file(const std::filesystem::path& file, std::uintmax_t max_bytes) {
  return parse_yaml(read_text_file(file, max_bytes), file);
}

std::string emit_yaml_line(const YamlTree& tree) { return emit_flow(tree); }

std::string emit_yaml(const YamlTree& tree) {
  if (on_one_line(tree)) return emit_flow(tree) + "\n";
  std::string text;
  emit_block(tree, "", false, &text);
  return text;
}

std::string range_text(const NumberRange& range) {
  const bool low = std::isfinite(range.min), high = std::isfinite(range.max);
  const bool positive = range.min == std::numeric_limits<double>::min();
  if (positive) return "above 0" + (high ? ", at most " + number_text(range.max) : "");
  if (low && high) return number_text(range.min) + " to " + number_text(range.max);
  if (low) return ">= " + number_text(range.min);
  return high ? "<= " + number_text(range.max) : "";
}

std::optional<double> read_number(const YamlTree& tree, const std::string& path, const NumberRange& range,
                                  Problems* problems) {
  const std::string limits = range_text(range);
  const std::string allowed = limits.empty() ? "a finite number" : "a number, " + limits;
  std::optional<double> value;
  if (tree.is_scalar() && !tree.quoted) value = parse_number(tree.scalar);
  if (!value) {
    add_problem(tree, path, "must be " + allowed, problems);
    return std::nullopt;
  }
  if (*value >= range.min && *value <= range.max) return value;
  add_problem(tree, path, "allowed is " + limits, problems);
  return std::nullopt;
}

std::optional<std::int64_t> read_integer(const YamlTree& tree, const std::string& path, const NumberRange& range,
                                         Problems* problems) {
  const std::string limits = range_text(range);
  std::optional<std::int64_t> value;
  if (tree.is_scalar() && !tree.quoted) value = parse_integer(tree.scalar);
  if (!value) {
    add_problem(tree, path, "must be a whole number" + (limits.empty() ? "" : ", " + limits), problems);
    return std::nullopt;
  }
  const auto as_double = static_cast<double>(*value);
  if (as_double >= range.min && as_double <= range.max) return value;
  add_problem(tree, path, "allowed is " + limits, problems);
  return std::nullopt;
}

std::optional<std::string> read_text(const YamlTree& tree, const std::string& path,
                                     const std::vector<std::string>& choices, Problems* problems) {
  if (!tree.is_scalar()) {
    add_problem(tree, path, choices.empty() ? "must be text" : "must be one of " + joined(choices), problems);
    return std::nullopt;
  }
  if (choices.empty() || std::find(choices.begin(), choices.end(), tree.scalar) != choices.end()) return tree.scalar;
  const std::optional<std::string> nearest = nearest_name(tree.scalar, choices);
  add_problem(tree, path, "must be one of " + joined(choices) + (nearest ? "; did you mean \"" + *nearest + "\"?" : ""),
              problems);
  return std::nullopt;
}

std::optional<std::vector<double>> read_numbers(const YamlTree& tree, const std::string& path, std::size_t size_min,
                                                std::size_t size_max, const NumberRange& range, Problems* problems) {
  if (!tree.is_sequence() || tree.items.size() < size_min || tree.items.size() > size_max) {
    std::string count = std::to_string(size_min);
    if (size_max != size_min)
      count = size_max == std::numeric_limits<std::size_t>::max() ? count + " or more"
                                                                  : count + " to " + std::to_string(size_max);
    add_problem(tree, path, "must be a list of " + count + " numbers", problems);
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < tree.items.size(); ++i) {
    const auto value = read_number(tree.items[i], path + "[" + std::to_string(i) + "]", range, problems);
    if (value) values.push_back(*value);
  }
  if (values.size() != tree.items.size()) return std::nullopt;
  return values;
}

std::optional<std::vector<std::string>> read_texts(const YamlTree& tree, const std::string& path, Problems* problems) {
  if (!tree.is_sequence()) {
    add_problem(tree, path, "must be a list of texts", problems);
    return std::nullopt;
  }
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < tree.items.size(); ++i)
    if (const auto text = read_text(tree.items[i], path + "[" + std::to_string(i) + "]", {}, problems))
      texts.push_back(*text);
  return texts;
}

MapReader::MapReader(const YamlTree& tree, std::string path, Problems* problems)
    : tree_(&tree), path_(std::move(path)), problems_(problems) {
  if (!tree.is_map() && !tree.is_null()) problem("", "must be a block of keys");
}

const YamlTree* MapReader::find(const std::string& key) {
  known_.push_back(key);
  return tree_->find(key);
}

std::string MapReader::path_of(const std::string& key) const {
  if (key.empty()) return path_;
  return path_.empty() ? for_message(key) : path_ + "." + for_message(key);
}

std::optional<double> MapReader::number(const std::string& key, const NumberRange& range) {
  const YamlTree* value = find(key);
  return value ? read_number(*value, path_of(key), range, problems_) : std::nullopt;
}

std::optional<std::int64_t> MapReader::integer(const std::string& key, const NumberRange& range) {
  const YamlTree* value = find(key);
  return value ? read_integer(*value, path_of(key), range, problems_) : std::nullopt;
}

std::optional<std::string> MapReader::text(const std::string& key, const std::vector<std::string>& choices) {
  const YamlTree* value = find(key);
  return value ? read_text(*value, path_of(key), choices, problems_) : std::nullopt;
}

std::optional<std::vector<double>> MapReader::numbers(const std::string& key, std::size_t size_min,
                                                      std::size_t size_max, const NumberRange& range) {
  const YamlTree* value = find(key);
  return value ? read_numbers(*value, path_of(key), size_min, size_max, range, problems_) : std::nullopt;
}

void MapReader::require(const std::string& key, const std::string& allowed) {
  if (find(key) == nullptr)
    problems_->add({tree_->file, tree_->line, path_of(key), "", "is missing; it must be " + allowed});
}

void MapReader::problem(const std::string& key, const std::string& message) {
  const YamlTree* value = key.empty() ? nullptr : tree_->find(key);
  const YamlTree& place = value ? *value : *tree_;
  const bool shows_value = value != nullptr || !(tree_->is_map() || tree_->is_null());
  problems_->add({place.file, place.line, path_of(key), shows_value ? place.shown() : "", message});
}

void MapReader::finish(const std::string& tolerated) {
  std::vector<std::string> known;
  for (const std::string& key : known_)
    if (std::find(known.begin(), known.end(), key) == known.end()) known.push_back(key);
  int unknown = 0;
  for (const auto& [key, value] : tree_->entries) {
    if (!tolerated.empty() && key.rfind(tolerated, 0) == 0) continue;
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    if (++unknown > kMaxUnknownKeys) return;
    problems_->add({value.file, value.line, path_of(key), "", "unknown key; " + suggestion(key, known)});
  }
}

}  // namespace rigproof
