// The message of the Error that a call throws.
#pragma once

#include <string>

#include "rigproof/core/error.h"

namespace rigproof {

/// Empty if the call throws nothing; any other exception passes through and fails the test.
template <typename Call>
std::string error_text(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace rigproof
