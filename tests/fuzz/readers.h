// Every reader of what somebody else may have written, behind one door: for the fuzzer, and for the seeds' replay.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rigproof::fuzz {

struct Reader {
  std::string name;  ///< of its seeds' folder, too
  /// Reads the bytes, from the file where the reader takes one: they are written there before. Throws Error for what it
  /// does not take; any other exception is a fault of the reader.
  std::function<void(const std::string& bytes, const std::filesystem::path& file)> read;
  std::string file = "input";  ///< name of that file below the scratch folder; empty: none is written
};

/// All of them.
const std::vector<Reader>& readers();

/// Lets the reader read the bytes, in a folder of this process that is removed at its end.
/// @return what the reader has against them, empty for nothing
std::string complaint_of(const Reader& reader, const std::string& bytes);

}  // namespace rigproof::fuzz
