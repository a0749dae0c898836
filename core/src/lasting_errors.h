// Errors that last, in a result's file.
#pragma once

#include <cstddef>
#include <optional>

#include "rigproof/core/fields.h"
#include "rigproof/core/result.h"

namespace rigproof {

/// @param joint covariance of camera_to_robot; there are none without
void visit_lasting(FieldVisitor& visitor, std::optional<LastingErrors>& lasting,
                   const std::optional<Eigen::MatrixXd>& joint);

}  // namespace rigproof
