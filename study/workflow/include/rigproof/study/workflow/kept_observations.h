// Observations of recordings that were looked at before: detection is most of what a calibration takes, and nothing is
// detected twice.
#pragma once

#include <ctime>
#include <filesystem>
#include <optional>
#include <string>

#include "rigproof/calib/vision/observe.h"

namespace rigproof {

/// Where observations are kept: $RIGPROOF_OBSERVATIONS, else rigproof/observations/ in $XDG_CACHE_HOME, else in
/// ~/.cache. Empty where that variable is empty, or where there is no home: then nothing is kept or recalled.
std::filesystem::path observations_folder();

/// Everything that observe() would depend on: this program with its libraries, the options, the recording as it was
/// read, and of each of its files name, size, inode, and the times at which its content and its inode changed. Taken
/// before anything is looked at. Empty where a file cannot be asked, or changed within two seconds before `now` (so
/// that another change would perhaps not show), or where nothing is kept.
std::string observations_key(const Recording& recording, const ObserveOptions& options,
                             std::time_t now = std::time(nullptr));

/// What was kept under a key, of this recording; absent for an empty key, and where that is not there, or is damaged.
std::optional<Observations> recall_observations(const std::string& key, const Recording& recording);

/// Keeps the observations, the newest 64 in all. What cannot be written is not kept, and nobody is told: it costs time
/// alone.
void keep_observations(const std::string& key, const Observations& observations);

}  // namespace rigproof
