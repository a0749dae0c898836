// Findings on disk: in results and in observations.json.
#pragma once

#include <string>
#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/observations.h"
#include "rigproof/core/yaml.h"

namespace rigproof {

/// A list; the sentence of each, where somebody words it, is for people alone.
YamlTree tree_of(const std::vector<Finding>& findings, const Wording& wording);
/// A list that may be absent. Plain text, as files of before and other programs write it, is a finding `stated`.
std::vector<Finding> read_findings(MapReader* map, const std::string& key, Severity severity);

/// code, values, because, depth. Files of before have a `reason` in words instead.
void set_exclusion(const Exclusion& exclusion, const Wording& wording, YamlTree* tree);
void read_exclusion(MapReader* map, Exclusion* exclusion);

}  // namespace rigproof
