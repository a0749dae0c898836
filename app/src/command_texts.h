// Completion and the manual, out of what the command line offers.
#pragma once

#include <string>
#include <vector>

#include "command_tree.h"

namespace rigproof {

std::vector<std::string> completion_shells();
/// A script for a shell of the list above.
std::string completion_script(const CommandFacts& program, const std::string& shell);
/// In the roff of man(7).
std::string manual_page(const CommandFacts& program);

}  // namespace rigproof
