#include "cdr_reader.h"

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

// Fast CDR wants memory that it might write; reading writes none.
char* unconst(const char* bytes) { return const_cast<char*>(bytes); }  // NOLINT(cppcoreguidelines-pro-type-const-cast)

}  // namespace

CdrReader::CdrReader(std::string_view bytes)
    : buffer_(unconst(bytes.data()), bytes.size()),
      cdr_(buffer_, fast_cdr::Cdr::DEFAULT_ENDIAN, fast_cdr::kPlainCdr),
      end_(bytes.data() + bytes.size()) {
  // Big- and little-endian; parameter lists and the second version of CDR have other numbers.
  if (bytes.size() < 4 || bytes[0] != 0 || (bytes[1] != 0 && bytes[1] != 1)) throw Error("is no plain CDR");
  cdr_.read_encapsulation();
}

std::size_t CdrReader::left() { return static_cast<std::size_t>(end_ - fast_cdr::position(cdr_)); }

std::size_t CdrReader::length(std::size_t element_bytes) {
  const auto count = number<std::uint32_t>();
  if (count > left() / element_bytes)
    throw Error("a list of " + std::to_string(count) + " elements in " + std::to_string(left()) + " bytes");
  return count;
}

std::string CdrReader::text() {
  std::string value(bytes());
  if (!value.empty() && value.back() == '\0') value.pop_back();
  return value;
}

std::string_view CdrReader::bytes() {
  const std::size_t size = length(1);
  const std::string_view view(fast_cdr::position(cdr_), size);
  if (size == 0) return view;
  // Fast CDR aligns by the last number read, which a jump does not change: the last byte is read as one.
  cdr_.jump(size - 1);
  number<std::uint8_t>();
  return view;
}

std::vector<double> CdrReader::numbers() {
  std::vector<double> values(length(sizeof(double)));
  for (double& value : values) value = number<double>();
  return values;
}

}  // namespace rigproof
