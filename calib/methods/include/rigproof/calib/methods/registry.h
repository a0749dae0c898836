// All calibration methods.
#pragma once

#include <string>
#include <vector>

#include "rigproof/calib/diagnose/method.h"

namespace rigproof {

/// All methods, in the order in which they are listed to users.
const std::vector<const Method*>& all_methods();
/// The steps from the MEMROC authors' chain to ours, cumulative, in their order; `joint_memroc_reference` is before the
/// first one, `joint_memroc` before `chain_reprojection`, `ml` after it. The last one is `ml` with the authors'
/// corners. Known by name, but not listed.
const std::vector<const Method*>& memroc_chain_methods();
/// One of these or those. Throws Error that names the listed ones (and the nearest) if there is none of that name.
const Method& find_method(const std::string& name);
/// The method that is used where the user names none.
const Method& default_method();

}  // namespace rigproof
