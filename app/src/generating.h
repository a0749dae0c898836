// What `generate` and `run` share: the configuration with its overrides, and generating with a line of progress.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "commands.h"
#include "rigproof/generator/config.h"
#include "rigproof/generator/generate.h"
#include "terminal.h"

namespace rigproof {

/// The configuration that the arguments name, with the --set overrides applied. Throws Error with every problem.
GenerateConfig configuration_of(const GenerateArguments& arguments);

/// Where the run goes: --output, else runs/<name of the configuration>.
std::filesystem::path output_of(const GenerateArguments& arguments, const GenerateConfig& config);

/// Generates or resumes and prints a line about it; `on_renderer` is called before the first image. Throws Error with
/// ExitCode::kTryAgain if the user interrupts.
GenerateReport generate_with_progress(const GenerateArguments& arguments, const GenerateConfig& config,
                                      const Terminal& terminal,
                                      const std::function<void(const std::string& gl_renderer)>& on_renderer = {});

/// Prints what generating would take.
int print_plan(const GenerateArguments& arguments, const GenerateConfig& config);

}  // namespace rigproof
