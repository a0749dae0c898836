// A calibration result as a person reads it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "rigproof/core/result.h"
#include "terminal.h"

namespace rigproof {

/// Rows of cells in columns, the first aligned left, the others right, with two spaces between.
std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows);

/// What a table has above the six values of a camera in the robot: lengths in centimetres, angles in degrees.
std::vector<std::string> with_axis_heads(std::vector<std::string> first);

/// "298 used, 2 left out (board cut off)": all cameras together, with the commonest reason.
std::string use_in_short(const Result& result);

/// Poses with stated sigma, refusals and notes.
void print_result(const Terminal& terminal, const Result& result);

/// What throws doubt on an answer, if anything.
void print_suspicions(const Terminal& terminal, const Result& result);

/// What was estimated beside the poses, if anything.
void print_also_estimated(const Terminal& terminal, const Result& result);

/// What the stated uncertainty mostly comes from and what to do about it, a line for axes that have it alike.
void print_main_sources(const Terminal& terminal, const Result& result);

/// Findings as a JSON list, in words beside.
nlohmann::json json_of(const std::vector<Finding>& findings);

/// A result, transforms as in its file.
nlohmann::json json_of(const Result& result);

}  // namespace rigproof
