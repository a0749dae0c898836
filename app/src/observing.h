// What `calibrate`, `run` and `inspect` share: observing with a line of progress, and methods by name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rigproof/calib/method.h"
#include "rigproof/core/observations.h"
#include "rigproof/formats/open_input.h"
#include "terminal.h"

namespace rigproof {

/// Throws Error that says what to do if the products of an input cannot go beside it.
void require_writable(const std::filesystem::path& product_folder);

/// Throws Error with ExitCode::kTryAgain if the user interrupts.
Observations observe_with_progress(const Input& input, int jobs, const Terminal& terminal);

/// The methods of these names, or the default one. Throws Error that names the nearest for an unknown one.
std::vector<const Method*> methods_by_name(const std::vector<std::string>& names);

}  // namespace rigproof
