// What `generate` and `run` share: the configuration with its overrides, and generating with a line of progress.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "rigproof/generator/config.h"
#include "rigproof/generator/generate.h"
#include "terminal.h"

namespace rigproof {

/// The configuration that the arguments name, with the --set overrides applied. Throws Error with every problem.
GenerateConfig configuration_of(const GenerateArguments& arguments);

/// Where the run goes: --output, else runs/<name of the configuration>.
std::filesystem::path output_of(const GenerateArguments& arguments, const GenerateConfig& config);

/// Worlds composed, viewpoints planned and drives simulated beside the rendering of the run before: one thread, which
/// works while this process waits for those that render.
class RunsAhead {
 public:
  struct Run {
    GenerateArguments arguments;
    GenerateConfig config;
  };
  /// Prepared in this order.
  explicit RunsAhead(std::vector<Run> runs) : runs_(std::move(runs)) {}
  /// Gives up what is being prepared.
  ~RunsAhead();
  RunsAhead(const RunsAhead&) = delete;
  RunsAhead& operator=(const RunsAhead&) = delete;

  const std::vector<Run>& runs() const { return runs_; }
  /// The run of this number, with a line of progress where it has to be waited for. Throws what preparing throws.
  std::shared_ptr<const Scenario> take(std::size_t number, const Terminal& terminal);
  /// Begins with the run after the one that was taken, if there is one.
  void start_next();

 private:
  void start(std::size_t number);

  std::vector<Run> runs_;
  std::size_t number_ = 0;  ///< of the run that is being prepared, or was taken
  std::future<std::shared_ptr<const Scenario>> prepared_;
  std::atomic<std::size_t> viewpoints_done_{0}, viewpoints_{0};  ///< of a drive that is being simulated
  std::atomic<bool> given_up_{false};
};

/// Generates or resumes run `number` and prints a line about it; `on_renderer` is called before the first image. Throws
/// Error with ExitCode::kTryAgain if the user interrupts.
GenerateReport generate_with_progress(RunsAhead* ahead, std::size_t number, const Terminal& terminal,
                                      const std::function<void(const std::string& gl_renderer)>& on_renderer = {});

/// Prints what generating would take.
int print_plan(const GenerateArguments& arguments, const GenerateConfig& config);

}  // namespace rigproof
