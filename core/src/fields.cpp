#include "rigproof/core/fields.h"

#include <set>

#include "rigproof/core/includes.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// ---------------------------------------------------------------------------------------------------------- reading

class Reader : public FieldVisitor {
 public:
  Reader(const YamlTree& tree, const std::string& path, Problems* problems)
      : tree_(tree), path_(path), problems_(problems) {}
  /// Of a block that is not there: nothing is missing in it.
  static Reader of_nothing(const YamlTree& nothing, const std::string& path, Problems* problems) {
    Reader reader(nothing, path, problems);
    reader.is_absent_ = true;
    return reader;
  }

  void value(const char* key, const FieldValue& value, const char*) override {
    const YamlTree* tree = map().find(key);
    if (tree == nullptr) return;
    const std::size_t before = problems_->all().size();
    value.read(*tree, map().path_of(key), problems_);
    if (problems_->all().size() > before) refused_.insert(key);
  }
  void section(const char* key, const VisitFields& visit, const char*) override {
    const YamlTree* tree = map().find(key);
    const YamlTree nothing;
    Reader reader = tree != nullptr ? Reader(*tree, map().path_of(key), problems_)
                                    : of_nothing(nothing, map().path_of(key), problems_);
    visit(reader);
    reader.finish();
  }
  void list(const char* key, const std::function<std::size_t()>& size, const std::function<void(std::size_t)>& resize,
            const std::function<void(std::size_t, FieldVisitor&)>& visit, const char*) override;
  void map(const char* key, const FieldMap& entries, const char*) override;
  bool instead(const TextInstead& text) override {
    if (!tree_.is_scalar()) return false;
    is_text_ = true;
    try {
      if (const auto read = read_text(tree_, path_, text.choices, problems_)) text.read(*read);
    } catch (const Error& error) {
      if (error.exit_code() == ExitCode::kTryAgain) throw;
      problems_->add({tree_.file, tree_.line, path_, tree_.shown(), error.what()});
    }
    return true;
  }
  bool takes(const char* key, bool) override { return map().has(key); }
  void check(bool holds, const char* key, const std::string& message) override {
    // What has no value because it was refused is not missing as well.
    if (!holds && refused_.count(key) == 0) map().problem(key, message);
  }
  void require(const char* key, const std::string& allowed) override {
    if (!is_absent_) map().require(key, allowed);
  }
  void tolerate(const char* prefix) override { tolerated_ = prefix; }
  const YamlTree* given(const char* key) override { return tree_.find(key); }
  Problems* problems() override { return problems_; }

  void know(const char* key) { map().find(key); }
  void finish() {
    if (!is_text_) map().finish(tolerated_);
  }

 private:
  // Not before a text in its stead was looked for: what is no block is told here.
  MapReader& map() {
    if (!map_) map_.emplace(tree_, path_, problems_);
    return *map_;
  }

  const YamlTree& tree_;
  const std::string path_;
  Problems* problems_;
  std::optional<MapReader> map_;
  std::set<std::string> refused_;
  std::string tolerated_;
  bool is_absent_ = false;
  bool is_text_ = false;
};

void Reader::list(const char* key, const std::function<std::size_t()>&, const std::function<void(std::size_t)>& resize,
                  const std::function<void(std::size_t, FieldVisitor&)>& visit, const char*) {
  const YamlTree* tree = map().find(key);
  if (tree == nullptr) return;
  if (!tree->is_sequence()) return map().problem(key, "must be a list");
  // Through zero, so that every element starts from its defaults.
  resize(0);
  resize(tree->items.size());
  for (std::size_t i = 0; i < tree->items.size(); ++i) {
    Reader reader(tree->items[i], map().path_of(key) + "[" + std::to_string(i) + "]", problems_);
    visit(i, reader);
    reader.finish();
  }
}

void Reader::map(const char* key, const FieldMap& entries, const char*) {
  const YamlTree* tree = map().find(key);
  if (tree == nullptr) return;
  MapReader all(*tree, map().path_of(key), problems_);
  const std::size_t size = tree->entries.size();
  if (size < entries.size_min || size > entries.size_max) all.problem("", entries.size_rule);
  if (size > entries.size_max) return;
  for (const auto& [name, entry] : tree->entries) {
    if (entries.is_name && !entries.is_name(name)) all.problem(name, entries.name_rule);
    Reader reader(entry, all.path_of(name), problems_);
    if (!entry.is_sequence() && !entry.is_scalar()) entries.visit(name, reader);
    reader.finish();
  }
}

// ---------------------------------------------------------------------------------------------------------- writing

class Writer : public FieldVisitor {
 public:
  explicit Writer(YamlTree* map) : map_(map) {}

  void value(const char* key, const FieldValue& value, const char*) override {
    if (auto tree = value.write()) map_->set(key, std::move(*tree));
  }
  void section(const char* key, const VisitFields& visit, const char*) override {
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
  void map(const char* key, const FieldMap& entries, const char*) override {
    YamlTree& map = map_->set(key, YamlTree::map());
    for (const std::string& name : entries.names()) {
      Writer writer(&map.set(name, YamlTree::map()));
      entries.visit(name, writer);
    }
  }
  bool instead(const TextInstead& text) override {
    const std::optional<std::string> written = text.write();
    if (written) *map_ = YamlTree::text(*written);
    return written.has_value();
  }
  bool takes(const char*, bool has_value) override { return has_value; }
  void on_one_line() override { map_->flow = true; }

 private:
  YamlTree* map_;
};

// "" for an empty text, the number of its entries for a list of blocks.
void flatten(const YamlTree& tree, const std::string& path, std::map<std::string, std::string>* leaves) {
  const std::string inner = path.empty() ? "" : path + ".";
  if (tree.is_map() && !tree.flow) {
    for (const auto& [key, value] : tree.entries) flatten(value, inner + key, leaves);
  } else if (tree.is_sequence() && !tree.flow) {
    (*leaves)[path] = std::to_string(tree.items.size()) + " entries";
    for (std::size_t i = 0; i < tree.items.size(); ++i)
      flatten(tree.items[i], path + "[" + std::to_string(i) + "]", leaves);
  } else {
    (*leaves)[path] = tree.is_scalar() ? (tree.scalar.empty() ? "''" : tree.scalar) : emit_yaml_line(tree);
  }
}

}  // namespace

void read_fields(const fs::path& file, const VisitFields& visit) {
  read_fields_of_tree(resolve_includes(read_yaml_file(file)), visit);
}

void read_fields_from_text(const std::string& text, const fs::path& file, const VisitFields& visit) {
  read_fields_of_tree(resolve_includes(parse_yaml(text, file)), visit);
}

void read_fields_of_tree(const YamlTree& tree, const VisitFields& visit) {
  Problems problems;
  read_fields_of_block(tree, "", &problems, visit);
  problems.sort();
  problems.throw_if_any();
}

void read_fields_of_block(const YamlTree& block, const std::string& path, Problems* problems,
                          const VisitFields& visit) {
  Reader reader(block, path, problems);
  // A file may name its schema.
  if (path.empty()) reader.know("$schema");
  visit(reader);
  reader.finish();
}

YamlTree tree_of_fields(const VisitFields& visit) {
  YamlTree tree = YamlTree::map();
  Writer writer(&tree);
  visit(writer);
  return tree;
}

std::string write_fields(const VisitFields& visit) { return emit_yaml(tree_of_fields(visit)); }

std::vector<FieldDifference> field_differences(const YamlTree& there, const YamlTree& here) {
  std::map<std::string, std::string> a, b;
  flatten(there, "", &a);
  flatten(here, "", &b);
  std::vector<FieldDifference> differences;
  const auto text_at = [](const std::map<std::string, std::string>& leaves, const std::string& path) {
    const auto found = leaves.find(path);
    return found == leaves.end() ? std::string("nothing") : found->second;
  };
  for (const auto& [path, value] : a)
    if (text_at(b, path) != value) differences.push_back({path, value, text_at(b, path)});
  for (const auto& [path, value] : b)
    if (a.count(path) == 0) differences.push_back({path, "nothing", value});
  return differences;
}

}  // namespace rigproof
