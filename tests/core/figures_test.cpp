#include "rigproof/core/figures.h"

#include <gtest/gtest.h>

#include <limits>

namespace rigproof {
namespace {

TEST(Figures, HaveNoLeadingZero) {
  EXPECT_EQ(figure(0.07, 2), ".07");
  EXPECT_EQ(figure(-0.07, 2), "-.07");
  EXPECT_EQ(figure(10.07, 1), "10.1");
  EXPECT_EQ(signed_figure(0.5, 2), "+.50");
  EXPECT_EQ(signed_figure(-12.5, 1), "-12.5");
}

TEST(Figures, ZeroIsPlain) {
  EXPECT_EQ(figure(0.0, 3), "0");
  EXPECT_EQ(figure(-0.0001, 3), "0");
  EXPECT_EQ(signed_figure(0.0001, 3), "0");
  EXPECT_EQ(short_figure(0.0), "0");
}

TEST(Figures, ExtremesStayShort) {
  EXPECT_EQ(figure(6.2e7, 3), "6.2e+07");
  EXPECT_EQ(figure(std::numeric_limits<double>::infinity(), 2), "inf");
  EXPECT_EQ(figure(std::numeric_limits<double>::quiet_NaN(), 2), "nan");
  EXPECT_EQ(short_figure(std::numeric_limits<double>::infinity()), "inf");
}

TEST(Figures, DecimalsFollowTheDigitsThatMatter) {
  EXPECT_EQ(decimals_for(0.0123, 2), 3);
  EXPECT_EQ(decimals_for(0.0996, 2), 2);  // rounds to .10
  EXPECT_EQ(decimals_for(123.0, 2), 0);
  EXPECT_EQ(decimals_for(1e-12, 2), 5);
  EXPECT_EQ(decimals_for_sigma(0.09), 2);
  EXPECT_EQ(decimals_for_sigma(0.13), 2);
  EXPECT_EQ(decimals_for_sigma(0.0031), 3);
  EXPECT_EQ(decimals_for_sigma(0.024), 3);
  EXPECT_EQ(short_figure(0.0111), ".011");
  EXPECT_EQ(short_figure(62.4), "62");
}

TEST(Figures, CountsInWords) {
  EXPECT_EQ(all_of_them(1), "one");
  EXPECT_EQ(all_of_them(2), "both");
  EXPECT_EQ(all_of_them(3), "all three");
  EXPECT_EQ(all_of_them(36), "all 36");
}

}  // namespace
}  // namespace rigproof
