// What imports from bags and from folders say and number the same way.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "frame_choice.h"
#include "ground_track.h"

namespace rigproof {

/// Options CAMERA=VALUE by camera; VALUE alone is for all where that is allowed. Throws Error for names of no camera.
std::map<std::string, std::string> values_by_camera(const std::vector<std::string>& texts, const char* option,
                                                    const std::vector<std::string>& cameras, bool for_all);
/// "000012".
std::string file_number(std::size_t number);
/// Which images were left out, and what keeps them.
std::vector<std::string> choice_notes(const FrameChoice& kept, int images_per_stop);
/// Empty where poses are level.
std::string level_note(const std::string& odometry, const GroundTrack& track);

}  // namespace rigproof
