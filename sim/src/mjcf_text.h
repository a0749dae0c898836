// Small pieces of MJCF text.
#pragma once

#include <initializer_list>
#include <string>

#include "rigproof/core/rigid3.h"

namespace rigproof {

/// Numbers with all their digits, separated by blanks; independent of the locale.
std::string numbers(std::initializer_list<double> values);
/// An XML attribute value in quotes, escaped.
std::string quoted(const std::string& text);
/// pos="x y z" quat="w x y z".
std::string pose_attributes(const Rigid3& T_parent_body);

}  // namespace rigproof
