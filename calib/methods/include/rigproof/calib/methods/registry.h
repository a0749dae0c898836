// All calibration methods.
#pragma once

#include <string>
#include <vector>

#include "rigproof/calib/diagnose/method.h"

namespace rigproof {

/// All methods, in the order in which they are listed to users.
const std::vector<const Method*>& all_methods();
/// Throws Error that names the known methods (and the nearest one) if there is none of that name.
const Method& find_method(const std::string& name);
/// The method that is used where the user names none.
const Method& default_method();

}  // namespace rigproof
