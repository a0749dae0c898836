#include "rigproof/core/pdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace rigproof {
namespace {

using testing::HasSubstr;

TEST(Pdf, OffsetsOfItsTableAreWhereObjectsBegin) {
  PdfPage page, second;
  page.width_pt = 100.0;
  page.height_pt = 50.5;
  page.operators = "0 0 10 10 re f\n";
  second.operators = "0 0 5 5 re f \n\n\n";
  const std::string pdf = pdf_document({page, second});
  EXPECT_EQ(pdf.rfind("%PDF-", 0), 0U);
  EXPECT_THAT(pdf, HasSubstr("/MediaBox [0 0 100 50.5]"));
  EXPECT_THAT(pdf, HasSubstr("/Length 15"));
  EXPECT_THAT(pdf, HasSubstr("/Length 16"));
  EXPECT_THAT(pdf, HasSubstr("/Kids [5 0 R 7 0 R ] /Count 2"));
  EXPECT_THAT(pdf.substr(pdf.find("\n5 0 obj")), HasSubstr("/Contents 6 0 R"));
  const std::size_t table = pdf.find("xref\n0 9\n");
  ASSERT_NE(table, std::string::npos);
  EXPECT_THAT(pdf.substr(table), HasSubstr("startxref\n" + std::to_string(table) + "\n%%EOF"));
  for (int object = 1; object <= 8; ++object) {
    const std::size_t line = table + 9 + static_cast<std::size_t>(20 * object);
    const auto offset = static_cast<std::size_t>(std::atol(pdf.substr(line, 10).c_str()));
    EXPECT_EQ(pdf.substr(offset, 7), std::to_string(object) + " 0 obj");
  }
}

TEST(Pdf, TextIsEscapedAndNumbersAreShort) {
  EXPECT_EQ(pdf_string("a (b) \\ \xc3\xa9 c"), "(a \\(b\\) \\\\ ?? c)");
  EXPECT_EQ(pdf_number(1.5), "1.5");
  EXPECT_EQ(pdf_number(-0.00001), "0");
  EXPECT_EQ(pdf_number(20.0), "20");
}

}  // namespace
}  // namespace rigproof
