// YAML as a tree that remembers file and line of everything, and a reader of maps that reports every problem at once.
// What is read may be hostile: size, depth and the number of nodes (after aliases) are bounded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {

/// One node. Plain data; also what a writer builds.
struct YamlTree {
  enum class Kind { kNull, kScalar, kSequence, kMap };
  Kind kind = Kind::kNull;
  std::string scalar;
  bool quoted = false;  ///< a quoted scalar is text, never a number
  bool flow = false;    ///< writer: on one line, as [a, b] or {a: b}
  std::vector<YamlTree> items;
  std::vector<std::pair<std::string, YamlTree>> entries;  ///< in the file's order
  std::string file;                                       ///< for messages
  int line = 0;                                           ///< of the value, 1-based; of the key for an entry of a map

  bool is_null() const { return kind == Kind::kNull; }
  bool is_scalar() const { return kind == Kind::kScalar; }
  bool is_sequence() const { return kind == Kind::kSequence; }
  bool is_map() const { return kind == Kind::kMap; }
  const YamlTree* find(const std::string& key) const;
  /// The value as a message shows it: the scalar, or "a list", "a block", "nothing".
  std::string shown() const;

  static YamlTree number(double value);
  static YamlTree integer(std::int64_t value);
  static YamlTree boolean(bool value);
  static YamlTree text(const std::string& value);
  /// [a, b, c] on one line.
  static YamlTree numbers(const std::vector<double>& values);
  static YamlTree texts(const std::vector<std::string>& values);
  static YamlTree sequence();
  static YamlTree map();
  /// A map that is written on one line.
  static YamlTree inline_map();
  /// Appends an entry to a map; returns its value.
  YamlTree& set(const std::string& key, YamlTree value);
  YamlTree& add(YamlTree item);
};

/// Parses one YAML document. A syntax error, a second document, a repeated key or an exceeded bound throws Error.
YamlTree parse_yaml(const std::string& text, const std::filesystem::path& file);
YamlTree read_yaml_file(const std::filesystem::path& file, std::uintmax_t max_bytes = 4U << 20U);
/// Block style with two spaces, `flow` nodes on one line. parse_yaml() reads the same tree back.
std::string emit_yaml(const YamlTree& tree);
/// The same tree on one line of YAML: [a, b], {key: value}.
std::string emit_yaml_line(const YamlTree& tree);
/// The same tree as JSON: on one line, or in lines that are indented by so many spaces a level.
std::string emit_json(const YamlTree& tree, int indent = -1);

/// Reads the entries of a map by key. What is asked for becomes a known key; finish() reports the others.
class MapReader {
 public:
  /// `path` is the dotted path of the map, empty at the top. A tree that is not a map is reported (nothing is: empty).
  MapReader(const YamlTree& tree, std::string path, Problems* problems);

  /// The entry, or nullptr; makes the key known.
  const YamlTree* find(const std::string& key);
  bool has(const std::string& key) { return find(key) != nullptr; }

  std::optional<double> number(const std::string& key, const NumberRange& range = {});
  std::optional<std::int64_t> integer(const std::string& key, const NumberRange& range = {});
  /// Non-empty text; one of `choices` if there are any.
  std::optional<std::string> text(const std::string& key, const std::vector<std::string>& choices = {});
  /// A list of size_min to size_max numbers.
  std::optional<std::vector<double>> numbers(const std::string& key, std::size_t size_min, std::size_t size_max,
                                             const NumberRange& range);

  /// Reports the key as missing unless it is there; `allowed` says what it should hold.
  void require(const std::string& key, const std::string& allowed);
  /// Reports a problem of one entry (or of the map itself for an empty key).
  void problem(const std::string& key, const std::string& message);
  /// Reports every key that was never asked for, with the nearest known one. Keys that start with `tolerated` pass.
  void finish(const std::string& tolerated = "");

  /// Dotted path of an entry.
  std::string path_of(const std::string& key) const;
  const YamlTree& tree() const { return *tree_; }
  Problems& problems() { return *problems_; }

 private:
  const YamlTree* tree_;
  std::string path_;
  Problems* problems_;
  std::vector<std::string> known_;
};

/// Checks of single nodes, shared by all readers; a wrong one becomes a Problem and the answer is empty.
std::optional<double> read_number(const YamlTree& tree, const std::string& path, const NumberRange& range,
                                  Problems* problems);
std::optional<std::int64_t> read_integer(const YamlTree& tree, const std::string& path, const NumberRange& range,
                                         Problems* problems);
std::optional<std::string> read_text(const YamlTree& tree, const std::string& path,
                                     const std::vector<std::string>& choices, Problems* problems);
std::optional<std::vector<double>> read_numbers(const YamlTree& tree, const std::string& path, std::size_t size_min,
                                                std::size_t size_max, const NumberRange& range, Problems* problems);
std::optional<std::vector<std::string>> read_texts(const YamlTree& tree, const std::string& path, Problems* problems);
/// "0 to 1", ">= 0", "<= 1", or nothing for no limit.
std::string range_text(const NumberRange& range);

}  // namespace rigproof
