#include "import_words.h"

#include <algorithm>

#include "rigproof/core/error.h"
#include "rigproof/core/text.h"

namespace rigproof {

std::map<std::string, std::string> values_by_camera(const std::vector<std::string>& texts, const char* option,
                                                    const std::vector<std::string>& cameras, bool for_all) {
  std::map<std::string, std::string> values;
  Problems problems;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name = equals == std::string::npos ? "" : text.substr(0, equals);
    if (name.empty() && for_all && equals == std::string::npos)
      for (const std::string& camera : cameras) values.emplace(camera, text);
    else if (std::find(cameras.begin(), cameras.end(), name) == cameras.end())
      problems.add({"", 0, option, for_message(text), "must be CAMERA=..; " + suggestion(name, cameras)});
    else
      values[name] = text.substr(equals + 1);
  }
  problems.throw_if_any();
  return values;
}

std::string file_number(std::size_t number) {
  const std::string digits = std::to_string(number);
  return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

std::vector<std::string> choice_notes(const FrameChoice& kept, int images_per_stop) {
  std::vector<std::string> notes;
  const std::string every = "; --every-image keeps all";
  if (kept.on_the_move)
    notes.push_back("the robot stood still at " + std::to_string(kept.stops) +
                    " places only: an image every 5 cm or 3 deg of the way is kept, " + std::to_string(kept.surplus) +
                    " others are left out" + every);
  if (kept.moving > 0)
    notes.push_back(std::to_string(kept.moving) + " images taken while the robot moved are left out" + every);
  if (!kept.on_the_move && kept.surplus > 0)
    notes.push_back(std::to_string(kept.surplus) +
                    " images of standstills are left out: " + std::to_string(images_per_stop) +
                    " of each stop and camera are enough (--images-per-stop)" + every);
  if (kept.outside > 0)
    notes.push_back(std::to_string(kept.outside) +
                    " images from before the odometry begins or after it ends are left out");
  return notes;
}

std::string level_note(const std::string& odometry, const GroundTrack& track) {
  constexpr double kLevel_deg = 1.0, kLevel_m = 0.05;
  if (track.tilt_deg <= kLevel_deg && track.rise_m <= kLevel_m) return "";
  return odometry + " is not level: it tilts by up to " + fixed_text(track.tilt_deg, 1) + " deg and rises by " +
         fixed_text(track.rise_m, 3) + " m; it is projected on the ground, as if the robot drove on a plane";
}

}  // namespace rigproof
