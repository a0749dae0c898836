// What tf2_ros' static_transform_publisher is told.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rigproof/study/export/export.h"

namespace rigproof::exporting {

/// Options with their values: --x .. --qw, --frame-id, --child-frame-id.
std::vector<std::pair<std::string, std::string>> static_tf_arguments(const TreeTransform& transform);

}  // namespace rigproof::exporting
