#include "rigproof/core/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "rigproof/core/random.h"

namespace rigproof {
namespace {

TEST(Text, NumbersReadBackToTheSameBits) {
  RandomStream random(1, "numbers");
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = (static_cast<std::uint64_t>(random.next_u32()) << 32U) | random.next_u32();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(parse_number(number_text(value)), value) << number_text(value);
  }
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(100.0), "100");
  EXPECT_EQ(short_text(0.123456, 3), "0.123");
  EXPECT_EQ(fixed_text(-2.0 / 3.0, 4), "-0.6667");
  EXPECT_EQ(fixed_text(1e300, 12).size(), 314U);
}

TEST(Text, OnlyWholeFiniteNumbersAreNumbers) {
  for (const char* text : {"", " 1", "1 ", "1,5", "0x10", "nan", "inf", "-inf", "1e999", "3 m", "++1", "+-1", "."})
    EXPECT_FALSE(parse_number(text)) << text;
  EXPECT_EQ(parse_number("+2.5e-1"), 0.25);
  EXPECT_EQ(parse_number(".5"), 0.5);
  EXPECT_EQ(parse_integer("-12"), -12);
  for (const char* text : {"1.0", "1e3", "9223372036854775808", "", "-"}) EXPECT_FALSE(parse_integer(text)) << text;
}

TEST(Text, TheNearestNameIsASlipAway) {
  const std::vector<std::string> known = {"lambda", "model", "height_m", "per_increment"};
  EXPECT_EQ(nearest_name("lamda", known), "lambda");
  EXPECT_EQ(nearest_name("mdoel", known), "model");
  EXPECT_EQ(nearest_name("Height_m", known), "height_m");
  EXPECT_EQ(nearest_name("height", known), "height_m");
  EXPECT_EQ(nearest_name("increment", known), "per_increment");
  EXPECT_EQ(nearest_name("height_mm", known), "height_m");
  EXPECT_EQ(nearest_name("yaw_deg", {"yam_rad", "yaw_rad"}), "yaw_rad") << "another unit of the same thing";
  EXPECT_FALSE(nearest_name("colour", known));
  EXPECT_FALSE(nearest_name("x", known));
  EXPECT_FALSE(nearest_name(std::string(100000, 'l'), known));
  EXPECT_FALSE(nearest_name("lambda", {}));
}

TEST(Text, SentencesStandApart) {
  EXPECT_EQ(sentences_text({}), "");
  EXPECT_EQ(sentences_text({"left: no board", "right: too far"}), "left: no board; right: too far");
  EXPECT_EQ(sentences_text({"It has no depth.", "left: no board", "Turn more!"}),
            "It has no depth. left: no board; Turn more!");
}

TEST(Text, WordsAreQuotedForAShellWhereTheyMustBe) {
  EXPECT_EQ(shell_word("a/b_1.5-c"), "a/b_1.5-c");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("my robot; $HOME"), "'my robot; $HOME'");
  EXPECT_EQ(shell_word("robot's"), "'robot'\\''s'");
}

TEST(Text, SizesAreForPeople) {
  EXPECT_EQ(megabytes(2.46e9), "2.5 GB");
  EXPECT_EQ(megabytes(12.4e6), "12 MB");
  EXPECT_EQ(megabytes(0.34e6), "0.3 MB");
  EXPECT_EQ(megabytes(3900.0), "4 kB");
  EXPECT_EQ(megabytes(0.0), "0 kB");
}

TEST(Text, MessagesShowNoControlCharacters) {
  EXPECT_EQ(for_message("a\x1b[31mred\n"), "a?[31mred?");
  EXPECT_EQ(for_message(std::string(200, 'x')), std::string(80, 'x') + "...");
  EXPECT_EQ(for_message("abcdef", 3), "abc...");
  EXPECT_EQ(for_message("\xC2\x9B[31mred"), "?[31mred");  // the same command as ESC [ to a terminal
  EXPECT_EQ(for_message("\xFF\xFEraw\xC3"), "??raw?");
  EXPECT_EQ(for_message("Stra\xC3\x9F"
                        "e",
                        5),
            "Stra\xC3\x9F...");  // a letter is whole or not there
}

}  // namespace
}  // namespace rigproof
