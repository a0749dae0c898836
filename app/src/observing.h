// What `calibrate`, `run` and `inspect` share: observing with a line of progress.
#pragma once

#include <filesystem>

#include "rigproof/calib/method.h"
#include "rigproof/core/observations.h"
#include "rigproof/formats/open_input.h"
#include "terminal.h"

namespace rigproof {

/// Throws Error that says what to do if the products of an input cannot go beside it.
void require_writable(const std::filesystem::path& product_folder);

/// Throws Error with ExitCode::kTryAgain if the user interrupts.
Observations observe_with_progress(const Input& input, int jobs, const Terminal& terminal);

/// What a method is given of an input.
MethodInput method_input(const Input& input, const Observations& observations, int jobs);

}  // namespace rigproof
