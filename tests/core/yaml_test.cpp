#include "rigproof/core/yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "error_text.h"
#include "rigproof/core/random.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

std::string parse_error(const std::string& text) {
  return error_text([&] { parse_yaml(text, "f.yaml"); });
}

TEST(Yaml, RemembersLines) {
  const YamlTree tree = parse_yaml("# head\na: 1\nb:\n  c: [1,\n    2]\n", "f.yaml");
  EXPECT_EQ(tree.find("a")->line, 2);
  EXPECT_EQ(tree.find("b")->line, 3);
  EXPECT_EQ(tree.find("b")->find("c")->line, 4);
  EXPECT_EQ(tree.find("b")->find("c")->items[1].line, 5);
}

TEST(Yaml, TellsQuotedTextFromNumbers) {
  const YamlTree tree = parse_yaml("a: 5\nb: \"5\"\nc: '5'\nd: !!str 5\ne: ~\nf:\n", "f.yaml");
  EXPECT_FALSE(tree.find("a")->quoted);
  for (const char* key : {"b", "c", "d"}) EXPECT_TRUE(tree.find(key)->quoted) << key;
  for (const char* key : {"e", "f"}) EXPECT_TRUE(tree.find(key)->is_null()) << key;
}

TEST(Yaml, RefusesWhatIsNotOnePlainDocument) {
  EXPECT_THAT(parse_error("a: [1, 2"), HasSubstr("f.yaml:1: not valid YAML"));
  EXPECT_EQ(parse_error("a: 1\nb: 2\na: 3\n"), "f.yaml:3: a: the key is given twice");
  EXPECT_THAT(parse_error("a: 1\n---\nb: 2\n"), HasSubstr("a second document"));
  EXPECT_EQ(parse_error(",d:m"), "f.yaml:1: not valid YAML: text that belongs to nothing before it");
  EXPECT_THAT(parse_error("? [1, 2]\n: 3\n"), HasSubstr("a key must be a word"));
  EXPECT_THAT(parse_error("a: *none\n"), HasSubstr("not valid YAML"));
}

TEST(Yaml, AliasesMayRepeatButNotExplode) {
  EXPECT_EQ(parse_yaml("a: &x [1, 2]\nb: *x\n", "f.yaml").find("b")->items.size(), 2U);
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last;
    for (int j = 0; j < 9; ++j) bomb += ", " + last;
    bomb += "]\n";
  }
  EXPECT_THAT(parse_error(bomb), HasSubstr("aliases expand to more values than the file has bytes"));
  EXPECT_NE(parse_error("a: &a [*a]\n"), "") << "an alias of itself";
}

TEST(Yaml, RefusesDeepNesting) {
  EXPECT_NE(parse_error(std::string(40, '[') + std::string(40, ']')), "");
  EXPECT_NE(parse_error(std::string(100000, '[')), "");
  EXPECT_NE(parse_error(std::string(100000, '{')), "");
  std::string blocks;
  for (int i = 0; i < 100; ++i) blocks += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  EXPECT_NE(parse_error(blocks + std::string(100, ' ') + "b: 1\n"), "");
}

bool same(const YamlTree& a, const YamlTree& b) {
  if (a.kind != b.kind || a.scalar != b.scalar || a.items.size() != b.items.size() ||
      a.entries.size() != b.entries.size())
    return false;
  for (std::size_t i = 0; i < a.items.size(); ++i)
    if (!same(a.items[i], b.items[i])) return false;
  for (std::size_t i = 0; i < a.entries.size(); ++i)
    if (a.entries[i].first != b.entries[i].first || !same(a.entries[i].second, b.entries[i].second)) return false;
  return true;
}

std::string random_text(RandomStream& random) {
  static const std::string kAlphabet = "ab1 :#-?,[]{}\"'\\\n\t&*!|>%@`~.=<";
  const auto letters = static_cast<std::uint32_t>(kAlphabet.size());
  std::string text;
  for (std::uint32_t i = random.below(8); i > 0; --i) {
    const std::uint32_t letter = random.below(letters + 1);
    text += letter < letters ? kAlphabet.substr(letter, 1) : "\xc3\xa4";
  }
  return text;
}

YamlTree random_tree(RandomStream& random, int depth) {
  const std::uint32_t kind = random.below(depth > 3 ? 3 : 5);
  if (kind == 0) return YamlTree::number(random.normal(0.0, 100.0));
  if (kind == 1) return YamlTree::text(random_text(random));
  if (kind == 2) return YamlTree::boolean(random.below(2) == 1);
  YamlTree tree = kind == 3 ? YamlTree::sequence() : YamlTree::map();
  tree.flow = random.below(3) == 0;
  for (std::uint32_t i = 0, count = 1 + random.below(4); i < count; ++i) {
    if (kind == 3)
      tree.add(random_tree(random, depth + 1));
    else
      tree.set(std::to_string(i) + random_text(random), random_tree(random, depth + 1));
  }
  return tree;
}

// Whatever text, nesting and style: what is emitted reads back to the same tree.
TEST(Yaml, EmittedTreesReadBack) {
  RandomStream random(1, "yaml");
  for (int i = 0; i < 2000; ++i) {
    YamlTree tree = YamlTree::map();
    tree.set("root", random_tree(random, 0));
    const std::string text = emit_yaml(tree);
    ASSERT_NO_THROW(ASSERT_TRUE(same(parse_yaml(text, "f.yaml"), tree)) << text) << text;
  }
}

// By the rule of YAML 1.1 for numbers, which PyYAML follows: [-+]?[0-9]+\.[0-9]*([eE][-+][0-9]+)?
TEST(Yaml, NumbersAreNumbersToOtherReaders) {
  for (const auto& [number, text] :
       {std::pair(8e-4, "8.0e-04"), {1.5e-7, "1.5e-07"}, {-1e22, "-1.0e+22"}, {0.25, "0.25"}}) {
    EXPECT_EQ(emit_yaml_line(YamlTree::number(number)), text);
    EXPECT_EQ(parse_number(text), number);
  }
  EXPECT_EQ(emit_yaml_line(YamlTree::text("1e5")), "\"1e5\"");
}

// Names of files may be any bytes.
TEST(Yaml, WhatIsEmittedIsUtf8) {
  EXPECT_EQ(emit_yaml_line(YamlTree::text("caf\xe9/x\xc3\xa4\xf0\x9f\x98\x80\xff")),
            "\"caf\xEF\xBF\xBD/x\xc3\xa4\xf0\x9f\x98\x80\xEF\xBF\xBD\"");
}

TEST(Yaml, WordsThatYamlTakesForSomethingElseAreQuoted) {
  for (const char* word : {"yes", "No", "null", "~", "true", "1", "-1", ".5", "0x1", "", "a: b", "#a", "- a", "..."}) {
    YamlTree tree = YamlTree::map();
    tree.set("a", YamlTree::text(word));
    const YamlTree again = parse_yaml(emit_yaml(tree), "f.yaml");
    ASSERT_TRUE(again.find("a")->is_scalar()) << word;
    EXPECT_EQ(again.find("a")->scalar, word);
  }
}

TEST(MapReader, ReportsUnknownKeysMissingKeysAndWrongShapes) {
  const YamlTree tree = parse_yaml("a: [1, 2, x]\nb: 1.5\nc: {d: 1}\nwidht: 3\nx-mine: 1\n", "f.yaml");
  Problems problems;
  MapReader map(tree, "top", &problems);
  map.numbers("a", 3, 3, {});
  map.integer("b", {0.0, 9.0});
  map.text("c");
  map.number("width");
  map.require("height", "a number");
  map.finish("x-");
  EXPECT_EQ(problems.text(),
            "f.yaml:1: top.a[2]: x: must be a finite number\n"
            "f.yaml:2: top.b: 1.5: must be a whole number, 0 to 9\n"
            "f.yaml:3: top.c: a block: must be text\n"
            "f.yaml:1: top.height: is missing; it must be a number\n"
            "f.yaml:4: top.widht: unknown key; did you mean \"width\"? known: a, b, c, width, height");
}

TEST(MapReader, AFloodOfUnknownKeysIsCut) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "k" + std::to_string(i) + ": 1\n";
  Problems problems;
  const YamlTree tree = parse_yaml(text, "f.yaml");
  MapReader(tree, "", &problems).finish();
  EXPECT_EQ(problems.all().size(), 20U);
}

}  // namespace
}  // namespace rigproof
