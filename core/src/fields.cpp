#include "rigproof/core/fields.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "rigproof/core/data_path.h"
#include "rigproof/core/includes.h"
#include "rigproof/core/yaml.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxIncludeDepth = 16;
const char* const kUniform = "uniform";
const char* const kNormal = "normal";
const char* const kChoice = "choice";

bool is_distribution(const YamlTree& tree) {
  return tree.is_map() && tree.entries.size() == 1 &&
         (tree.find(kUniform) != nullptr || tree.find(kNormal) != nullptr || tree.find(kChoice) != nullptr);
}

// What `over` says wins; blocks are merged key by key, anything else (lists, distributions) is replaced whole.
void merge_into(YamlTree* base, YamlTree over) {
  const bool replaced = !base->is_map() || !over.is_map() || is_distribution(*base) || is_distribution(over);
  if (replaced) {
    *base = std::move(over);
    return;
  }
  for (auto& [key, value] : over.entries) {
    const auto same = [&key = key](const auto& entry) { return entry.first == key; };
    const auto place = std::find_if(base->entries.begin(), base->entries.end(), same);
    if (place == base->entries.end())
      base->entries.emplace_back(key, std::move(value));
    else
      merge_into(&place->second, std::move(value));
  }
  base->file = over.file;
  base->line = over.line;
}

std::vector<std::string> included_names(const YamlTree& include, Problems* problems) {
  std::vector<std::string> names;
  const auto add = [&](const YamlTree& item) {
    if (const auto name = read_text(item, "include", {}, problems)) names.push_back(*name);
  };
  if (include.is_sequence())
    std::for_each(include.items.begin(), include.items.end(), add);
  else
    add(include);
  return names;
}

// Relative to the including file, else a preset of config/.
fs::path included_file(const std::string& name, const YamlTree& include) {
  const fs::path beside = fs::path(include.file).parent_path() / name;
  std::error_code ignored;
  if (fs::is_regular_file(beside, ignored)) return beside;
  try {
    return find_data_file("config", name);
  } catch (const Error& error) {
    throw Error(Problem{include.file, include.line, "include", for_message(name),
                        "there is no such file beside this one, and no preset: " + std::string(error.what())}
                    .text());
  }
}

YamlTree with_includes(YamlTree tree, int depth) {
  const YamlTree* include = tree.find("include");
  if (include == nullptr) return tree;
  if (depth >= kMaxIncludeDepth)
    throw Error(Problem{tree.file, include->line, "include", "", "files include each other without end"}.text());
  Problems problems;
  YamlTree merged = YamlTree::map();
  for (const std::string& name : included_names(*include, &problems))
    merge_into(&merged, with_includes(read_yaml_file(included_file(name, *include)), depth + 1));
  problems.throw_if_any();
  const auto is_include = [](const auto& entry) { return entry.first == "include"; };
  tree.entries.erase(std::remove_if(tree.entries.begin(), tree.entries.end(), is_include), tree.entries.end());
  merge_into(&merged, std::move(tree));
  return merged;
}

// ---------------------------------------------------------------------------------------------------------- reading

class Reader : public FieldVisitor {
 public:
  Reader(const YamlTree& tree, const std::string& path, Problems* problems) : map_(tree, path, problems) {}

  void field(const char* key, double& value, const NumberRange& range, const char*) override {
    if (const auto number = map_.number(key, range)) value = *number;
  }
  void field(const char* key, std::int64_t& value, const NumberRange& range, const char*) override {
    if (const auto number = map_.integer(key, range)) value = *number;
  }
  void field(const char* key, bool& value, const char*) override {
    if (const auto boolean = map_.boolean(key)) value = *boolean;
  }
  void field(const char* key, std::string& value, const TextChoices& choices, const char*) override {
    const auto text = map_.text(key, choices.choices);
    if (text) value = *text;
    if (!text && map_.has(key)) refused_.insert(key);
  }
  void field(const char* key, Distribution& value, const NumberRange& range, const char*) override;
  void field(const char* key, std::vector<double>& value, const NumberRange& range, std::size_t size_min,
             std::size_t size_max, const char*) override {
    if (const auto numbers = map_.numbers(key, size_min, size_max, range)) value = *numbers;
  }
  void field(const char* key, std::vector<std::string>& value, const char*) override {
    if (const auto texts = map_.texts(key)) value = *texts;
  }
  void section(const char* key, const std::function<void(FieldVisitor&)>& visit, const char*) override;
  void list(const char* key, const std::function<std::size_t()>& size, const std::function<void(std::size_t)>& resize,
            const std::function<void(std::size_t, FieldVisitor&)>& visit, const char*) override;
  void check(bool holds, const char* key, const std::string& message) override {
    // What has no value because its text was refused is not missing as well.
    if (!holds && refused_.count(key) == 0) map_.problem(key, message);
  }
  void finish() { map_.finish(); }
  void know(const char* key) { map_.find(key); }

 private:
  MapReader map_;
  std::set<std::string> refused_;
};

// Built in place: g++ with sanitizers takes the move of a variant for a read of what it does not hold.
template <typename Kind>
std::optional<Distribution> distribution_of(Kind kind) {
  std::optional<Distribution> distribution;
  distribution.emplace(Distribution::Kind(std::in_place_type<Kind>, std::move(kind)));
  return distribution;
}

std::optional<Distribution> read_uniform(const YamlTree& tree, const std::string& path, Problems* problems) {
  const auto ends = read_numbers(tree, path, 2, 2, {}, problems);
  if (!ends) return std::nullopt;
  if ((*ends)[0] <= (*ends)[1]) return distribution_of(Distribution::Uniform{(*ends)[0], (*ends)[1]});
  problems->add({tree.file, tree.line, path, number_text((*ends)[0]) + ", " + number_text((*ends)[1]),
                 "must be [low, high] with low <= high"});
  return std::nullopt;
}

std::optional<Distribution> read_normal(const YamlTree& tree, const std::string& path, Problems* problems) {
  MapReader map(tree, path, problems);
  map.require("mean", "a number");
  map.require("stddev", "a number, >= 0");
  const auto mean = map.number("mean");
  const auto stddev = map.number("stddev", {0.0});
  map.finish();
  if (!mean || !stddev) return std::nullopt;
  return distribution_of(Distribution::Normal{*mean, *stddev});
}

std::optional<Distribution> read_choice(const YamlTree& tree, const std::string& path, Problems* problems) {
  const auto values = read_numbers(tree, path, 1, 10000, {}, problems);
  if (!values) return std::nullopt;
  return distribution_of(Distribution::Choice{*values});
}

std::optional<Distribution> read_distribution(const YamlTree& tree, const std::string& path, Problems* problems) {
  if (tree.is_scalar()) {
    const auto number = read_number(tree, path, {}, problems);
    return number ? std::optional<Distribution>(*number) : std::nullopt;
  }
  if (!is_distribution(tree)) {
    problems->add({tree.file, tree.line, path, tree.shown(),
                   "must be a number, {uniform: [low, high]}, {normal: {mean: m, stddev: s}} or {choice: [..]}"});
    return std::nullopt;
  }
  const auto& [kind, value] = tree.entries.front();
  const std::string inner = path + "." + kind;
  if (kind == kUniform) return read_uniform(value, inner, problems);
  return kind == kNormal ? read_normal(value, inner, problems) : read_choice(value, inner, problems);
}

void Reader::field(const char* key, Distribution& value, const NumberRange& range, const char*) {
  const YamlTree* tree = map_.find(key);
  if (tree == nullptr) return;
  const auto distribution = read_distribution(*tree, map_.path_of(key), &map_.problems());
  if (!distribution) return;
  const double low = distribution->lowest(), high = distribution->highest();
  if (low >= range.min && high <= range.max) {
    value = *distribution;
    return;
  }
  const bool constant = tree->is_scalar();
  const std::string drawn = "draws from " + number_text(low) + " to " + number_text(high) + ", ";
  map_.problem(key, (constant ? "" : drawn) + "allowed is " + range_text(range));
}

void Reader::section(const char* key, const std::function<void(FieldVisitor&)>& visit, const char*) {
  const YamlTree* tree = map_.find(key);
  if (tree == nullptr || tree->is_null()) {
    // Checks that concern several fields hold for defaults, too.
    const YamlTree nothing;
    Reader reader(nothing, map_.path_of(key), &map_.problems());
    visit(reader);
    return;
  }
  Reader reader(*tree, map_.path_of(key), &map_.problems());
  visit(reader);
  if (tree->is_map()) reader.finish();
}

void Reader::list(const char* key, const std::function<std::size_t()>&, const std::function<void(std::size_t)>& resize,
                  const std::function<void(std::size_t, FieldVisitor&)>& visit, const char*) {
  const YamlTree* tree = map_.find(key);
  if (tree == nullptr) return;
  if (!tree->is_sequence()) {
    map_.problem(key, "must be a list of blocks");
    return;
  }
  // Through zero, so that every element starts from its defaults.
  resize(0);
  resize(tree->items.size());
  for (std::size_t i = 0; i < tree->items.size(); ++i) {
    Reader reader(tree->items[i], map_.path_of(key) + "[" + std::to_string(i) + "]", &map_.problems());
    visit(i, reader);
    reader.finish();
  }
}

// ---------------------------------------------------------------------------------------------------------- writing

YamlTree tree_of(const Distribution& distribution) {
  YamlTree tree = YamlTree::inline_map();
  struct {
    YamlTree& tree;
    void operator()(double constant) const { tree = YamlTree::number(constant); }
    void operator()(const Distribution::Uniform& u) const { tree.set(kUniform, YamlTree::numbers({u.low, u.high})); }
    void operator()(const Distribution::Normal& n) const {
      YamlTree& normal = tree.set(kNormal, YamlTree::inline_map());
      normal.set("mean", YamlTree::number(n.mean));
      normal.set("stddev", YamlTree::number(n.standard_deviation));
    }
    void operator()(const Distribution::Choice& c) const { tree.set(kChoice, YamlTree::numbers(c.values)); }
  } write{tree};
  std::visit(write, distribution.kind());
  return tree;
}

class Writer : public FieldVisitor {
 public:
  explicit Writer(YamlTree* map) : map_(map) {}

  void field(const char* key, double& value, const NumberRange&, const char*) override {
    map_->set(key, YamlTree::number(value));
  }
  void field(const char* key, std::int64_t& value, const NumberRange&, const char*) override {
    map_->set(key, YamlTree::integer(value));
  }
  void field(const char* key, bool& value, const char*) override { map_->set(key, YamlTree::boolean(value)); }
  void field(const char* key, std::string& value, const TextChoices&, const char*) override {
    map_->set(key, YamlTree::text(value));
  }
  void field(const char* key, Distribution& value, const NumberRange&, const char*) override {
    map_->set(key, tree_of(value));
  }
  void field(const char* key, std::vector<double>& value, const NumberRange&, std::size_t, std::size_t,
             const char*) override {
    map_->set(key, YamlTree::numbers(value));
  }
  void field(const char* key, std::vector<std::string>& value, const char*) override {
    YamlTree list = YamlTree::sequence();
    list.flow = true;
    for (const std::string& text : value) list.add(YamlTree::text(text));
    map_->set(key, std::move(list));
  }
  void section(const char* key, const std::function<void(FieldVisitor&)>& visit, const char*) override {
    Writer writer(&map_->set(key, YamlTree::map()));
    visit(writer);
  }
  void list(const char* key, const std::function<std::size_t()>& size, const std::function<void(std::size_t)>&,
            const std::function<void(std::size_t, FieldVisitor&)>& visit, const char*) override {
    YamlTree& list = map_->set(key, YamlTree::sequence());
    for (std::size_t i = 0; i < size(); ++i) {
      Writer writer(&list.add(YamlTree::map()));
      visit(i, writer);
    }
  }
  void check(bool, const char*, const std::string&) override {}

 private:
  YamlTree* map_;
};

void read_tree(YamlTree tree, const VisitFields& visit) {
  tree = with_includes(std::move(tree), 0);
  Problems problems;
  Reader reader(tree, "", &problems);
  reader.know("$schema");
  visit(reader);
  reader.finish();
  problems.sort();
  problems.throw_if_any();
}

}  // namespace

void read_fields(const fs::path& file, const VisitFields& visit) { read_tree(read_yaml_file(file), visit); }

void read_fields_from_text(const std::string& text, const fs::path& file, const VisitFields& visit) {
  read_tree(parse_yaml(text, file), visit);
}

void read_fields_of_block(const YamlTree& block, const std::string& path, Problems* problems,
                          const VisitFields& visit) {
  Reader reader(block, path, problems);
  visit(reader);
  if (block.is_map()) reader.finish();
}

YamlTree resolve_includes(YamlTree tree) { return with_includes(std::move(tree), 0); }

std::string write_fields(const VisitFields& visit) {
  YamlTree tree = YamlTree::map();
  Writer writer(&tree);
  visit(writer);
  return emit_yaml(tree);
}

}  // namespace rigproof
