// Sentences with numbers in them.
#pragma once

#include <cstdio>
#include <string>

namespace rigproof::ml {

/// printf into a string; 511 characters at most.
template <typename... Args>
std::string format(const char* pattern, Args... args) {
  char text[512];
  std::snprintf(text, sizeof(text), pattern, args...);
  return text;
}

}  // namespace rigproof::ml
