// One declaration of a configuration: each struct lists its fields once in `void visit(FieldVisitor&)`, and from that
// list come the reader (with all its errors), the writer of the resolved configuration, the JSON Schema and the docs.
// The default of a field is its in-class initialiser.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "rigproof/core/distribution.h"
#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {

struct YamlTree;

/// Allowed values of a text: one of `choices`, or anything if there is none.
struct TextChoices {
  std::vector<std::string> choices;
};

/// Visits the fields of a configuration. Keys carry their unit (height_m, yaw_deg); the member that is visited holds
/// the value in the key's unit as well, so that the file, the schema and the struct agree.
class FieldVisitor {
 public:
  virtual ~FieldVisitor() = default;
  virtual void field(const char* key, double& value, const NumberRange& range, const char* description) = 0;
  virtual void field(const char* key, std::int64_t& value, const NumberRange& range, const char* description) = 0;
  virtual void field(const char* key, bool& value, const char* description) = 0;
  virtual void field(const char* key, std::string& value, const TextChoices& choices, const char* description) = 0;
  /// A number or a distribution of it: {uniform: [a, b]}, {normal: {mean: m, stddev: s}}, {choice: [..]}.
  virtual void field(const char* key, Distribution& value, const NumberRange& range, const char* description) = 0;
  /// A list of numbers; size_min <= length <= size_max.
  virtual void field(const char* key, std::vector<double>& value, const NumberRange& range, std::size_t size_min,
                     std::size_t size_max, const char* description) = 0;
  virtual void field(const char* key, std::vector<std::string>& value, const char* description) = 0;
  /// A nested block whose fields `visit` lists.
  virtual void section(const char* key, const std::function<void(FieldVisitor&)>& visit, const char* description) = 0;
  /// A list of blocks. `resize` sets the length when reading; `visit` lists the fields of element i.
  /// When `size` is 0 a schema writer visits element 0 of a list resized to 1 and empties it again.
  virtual void list(const char* key, const std::function<std::size_t()>& size,
                    const std::function<void(std::size_t)>& resize,
                    const std::function<void(std::size_t, FieldVisitor&)>& visit, const char* description) = 0;
  /// Reports a problem that concerns several fields together; only a reader keeps it.
  virtual void check(bool holds, const char* key, const std::string& message) = 0;

  /// A nested struct with a visit() of its own.
  template <typename Struct>
  void nested(const char* key, Struct& value, const char* description) {
    section(
        key, [&value](FieldVisitor& visitor) { value.visit(visitor); }, description);
  }
  /// A list of such structs.
  template <typename Struct>
  void nested_list(const char* key, std::vector<Struct>& values, const char* description) {
    list(
        key, [&values] { return values.size(); }, [&values](std::size_t size) { values.resize(size); },
        [&values](std::size_t i, FieldVisitor& visitor) { values[i].visit(visitor); }, description);
  }
};

using VisitFields = std::function<void(FieldVisitor&)>;

/// Reads a YAML file into the fields. Unknown keys, wrong types and values out of range become Problems with
/// file:line, the field's dotted path, the value and what is allowed; an unknown key names the nearest known one.
/// `include: FILE` (or a list of them) is read first, relative to the including file. An empty file is fine.
/// Throws Error with all problems.
void read_fields(const std::filesystem::path& file, const VisitFields& visit);
/// The same from text; `file` is used in messages and to resolve includes.
void read_fields_from_text(const std::string& text, const std::filesystem::path& file, const VisitFields& visit);

/// The same for a block of a larger file: `path` is its place in that file, problems are left to the caller.
void read_fields_of_block(const YamlTree& block, const std::string& path, Problems* problems, const VisitFields& visit);

/// YAML with every field and its value: the resolved configuration, which reads back to the same values.
std::string write_fields(const VisitFields& visit);

/// JSON Schema (draft 7) of the fields, with descriptions, defaults and ranges.
std::string schema_of_fields(const std::string& title, const VisitFields& visit);

}  // namespace rigproof
