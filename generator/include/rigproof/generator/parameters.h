// Every parameter of a run's configuration, and whether a change of it needs rendering.
#pragma once

#include <string>
#include <vector>

#include "rigproof/generator/config.h"

namespace rigproof {

enum class ParameterKind {
  kRender,  ///< clean renders depend on it
  kSense    ///< only what is made of them does
};

struct Parameter {
  std::string path;  ///< dotted, as --set takes it: "sensing.depth.bias_field"
  ParameterKind kind = ParameterKind::kRender;
};

/// All of them, in the order in which the configuration declares them; a list is one.
std::vector<Parameter> all_parameters();

/// Paths of the render keys that differ.
std::vector<std::string> changed_render_keys(const GenerateConfig& there, const GenerateConfig& here);

/// The configuration with every sense key at its default: equal for runs whose clean pictures and drives are equal.
GenerateConfig without_sense_keys(const GenerateConfig& config);

}  // namespace rigproof
