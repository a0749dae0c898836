// Solves empty observations with every method: each must refuse in words.
#include <cstdio>

#include "rigproof/calib/methods/registry.h"
#include "rigproof/words/sentences.h"

int main() {
  for (const rigproof::Method* method : rigproof::all_methods()) {
    const rigproof::Result result = method->solve(rigproof::Observations());
    if (result.status != rigproof::ResultStatus::kRefused || result.reasons.empty()) return 1;
    std::printf("%s: %s\n", method->traits().name.c_str(), rigproof::words::text_of(result.reasons).c_str());
  }
  return 0;
}
