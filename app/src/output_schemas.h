// What commands print for machines.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/fields.h"

namespace rigproof {

/// The output of one command with --json.
struct OutputSchema {
  std::string command;  ///< "calibrate", "sweep status"
  std::string note;     ///< behind its line in the list of schemas
  std::vector<KeyLine> keys;
};

std::vector<OutputSchema> output_schemas();
/// As `rigproof schema` takes it: "calibrate_output".
std::string name_of(const OutputSchema& output);
std::string schema_of(const OutputSchema& output);

}  // namespace rigproof
