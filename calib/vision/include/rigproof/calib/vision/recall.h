// Finding something in a picture unless it has been found before.
#pragma once

#include <optional>
#include <string>

#include "rigproof/calib/vision/picture_memory.h"

namespace rigproof::detection {

/// What a memory holds under a key, else what `find` finds; that is kept where `find` returns true. An empty key is
/// neither looked up nor kept; `memory` may be null then. Found needs bytes_of() and read_bytes() in its namespace.
template <typename Found, typename Find>
void recall_or(PictureMemory* memory, PictureMemory::Finding finding, const std::string& key, Found* found,
               const Find& find) {
  if (!key.empty())
    if (const std::optional<std::string> bytes = memory->recall(finding, key))
      if (read_bytes(*bytes, found)) return;
  const bool worth_keeping = find();
  if (!key.empty() && worth_keeping) memory->keep(finding, key, bytes_of(*found));
}

/// Hash of what a file of the recording holds; empty where there is no memory, or it does not know.
inline std::string content_of(const PictureMemory* memory, const std::string& file) {
  return memory == nullptr ? std::string() : memory->content_of(file);
}

}  // namespace rigproof::detection
