// `include:` of a YAML file, for readers that are not read_fields().
#pragma once

#include "rigproof/core/yaml.h"

namespace rigproof {

/// The tree with what its `include: FILE` (or a list of them) names merged in below it, as read_fields() does. Nodes
/// remember the file that they came from. Throws Error.
YamlTree resolve_includes(YamlTree tree);

}  // namespace rigproof
