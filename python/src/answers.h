// Results made of what Python functions answer.
#pragma once

#include "bindings.h"
#include "rigproof/core/result.h"

namespace rigproof::python {

/// A solved result. Throws ValueError and TypeError.
Result result_of_poses(const std::string& method, const py::dict& poses, const std::string& robot_frame,
                       const py::dict& covariances);

}  // namespace rigproof::python
