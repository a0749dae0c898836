// The main function of benchmarks that take options.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "rigproof/core/error.h"

namespace rigproof {

/// Reads the command line and works; an Error is a line on stderr and its exit code. --help shows `help`.
/// @param declare takes the CLI::App that gets the options
/// @param work returns the exit code
template <typename Declare, typename Work>
int bench_main(int count, char** arguments, const std::string& help, const Declare& declare, const Work& work) {
  CLI::App app(help);
  declare(app);
  try {
    app.parse(count, arguments);
    return work();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kBadInput);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.exit_code());
  }
}

/// A whole number from 0.
template <typename Number>
CLI::Option* add_count(CLI::App& app, const std::string& name, Number& value) {
  return app.add_option(name, value)->check(CLI::Range(0, 1000000));
}

}  // namespace rigproof
