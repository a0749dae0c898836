// Whether cameras and odometry of a bag tell the same time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bag_import.h"
#include "bag_survey.h"

namespace rigproof {

/// Keeps what a double holds of nanoseconds since 1970.
double seconds(std::int64_t ns);

/// Notes on cameras whose headers lag behind the log otherwise than those of the odometry.
/// @param plan has its cameras and its odometry
/// Throws Error that names every camera whose stamps never meet those of the odometry.
std::vector<std::string> notes_of_clocks(const BagSurvey& survey, bool log_stamps, const std::string& odometry,
                                         const ImportPlan& plan);

/// Throws Error with every camera that has several images of one stamp.
void check_stamps_differ(const ImportPlan& plan, bool log_stamps);

}  // namespace rigproof
