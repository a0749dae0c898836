// What `calibrate`, `run` and `inspect` share: observing with a line of progress.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "commands.h"
#include "rigproof/calib/diagnose/method.h"
#include "rigproof/calib/vision/feature_source.h"
#include "rigproof/calib/vision/horizon_source.h"
#include "rigproof/core/observations.h"
#include "rigproof/formats/format.h"
#include "terminal.h"

namespace rigproof {

/// Where products of an input go: the output that the user named, else `name` beside the input. Throws Error that says
/// what to do if they cannot go there.
std::filesystem::path product_place(const Input& input, const std::filesystem::path& output, const std::string& name);

/// Throws Error with ExitCode::kTryAgain if the user interrupts.
Observations observe_with_progress(const Input& input, int jobs, const Terminal& terminal);

/// Those of an earlier look at the same images; absent where there was none, or where there are no images.
std::optional<Observations> observed_before(const Input& input);

/// What the user named to look at images with. Made before anything is read, so that a wrong name or network is told at
/// once.
struct Vision {
  Vision() = default;
  /// Throws Error.
  explicit Vision(const VisionArguments& arguments);
  std::string ground = "depth";
  std::unique_ptr<FeatureSource> features;
  std::unique_ptr<HorizonSource> horizon;
};

/// As above, with the ground from where the user wants it; says which cameras have theirs from images.
Observations observe_with_progress(const Input& input, const Vision& vision, int jobs, const Terminal& terminal);

/// Name of the result of a method, and of its file: with the options that are not the usual ones, as
/// "ml-ground_images".
std::string result_name(const std::string& method, const VisionArguments& vision);

/// What a method is given of an input.
MethodInput method_input(const Input& input, const Observations& observations, const Vision& vision, int jobs);

/// run_method() with a line of progress where the method reads images.
Result run_with_progress(const Method& method, MethodInput input, const Terminal& terminal);

}  // namespace rigproof
