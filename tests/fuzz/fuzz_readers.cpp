// libFuzzer's entry. RIGPROOF_FUZZ names the reader: RIGPROOF_FUZZ=rig fuzz_readers -timeout=1 corpus
// tests/fuzz/seeds/rig
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "readers.h"

namespace {

using rigproof::fuzz::Reader;

const Reader& chosen_reader() {
  const char* const name = std::getenv("RIGPROOF_FUZZ");
  for (const Reader& reader : rigproof::fuzz::readers())
    if (name != nullptr && reader.name == name) return reader;
  std::fprintf(stderr, "RIGPROOF_FUZZ: names no reader; there are:");
  for (const Reader& reader : rigproof::fuzz::readers()) std::fprintf(stderr, " %s", reader.name.c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Reader& reader = chosen_reader();
  rigproof::fuzz::complaint_of(reader, std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
