// Configuration of the straight drive beside the viewpoints.
#pragma once

#include <cstdint>

#include "rigproof/core/fields.h"

namespace rigproof {

struct StraightDriveConfig {
  std::int64_t frames = 0;  ///< of each camera; 0 = none

  void visit(FieldVisitor& visitor);
};

}  // namespace rigproof
