// One YAML file over another: what `include:` and overrides do.
#pragma once

#include "rigproof/core/yaml.h"

namespace rigproof {

/// Whether a block is {uniform: ..}, {normal: ..} or {choice: ..}: one value, which is replaced whole.
bool is_distribution(const YamlTree& tree);
/// What `over` says wins; blocks are merged key by key, anything else (lists, distributions) is replaced whole.
void merge_into(YamlTree* base, YamlTree over);
/// The tree with what its `include: FILE` (or a list of them) names merged in below it, as read_fields() does. Nodes
/// remember the file that they came from. Throws Error.
YamlTree resolve_includes(YamlTree tree);

}  // namespace rigproof
