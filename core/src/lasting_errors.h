// Errors that last, in a result's file.
#pragma once

#include <cstddef>
#include <optional>

#include "rigproof/core/fields.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// @param of_cameras rows of the joint covariance of the cameras
void visit_lasting(FieldVisitor& visitor, std::optional<LastingErrors>& lasting, std::size_t of_cameras);

}  // namespace rigproof
