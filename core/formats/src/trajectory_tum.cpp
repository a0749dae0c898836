// TUM RGB-D's trajectories, which most SLAM programs write, too.
#include "rigproof/formats/trajectory.h"

namespace rigproof {
namespace {

constexpr const char* kLayout = "stamp_s tx ty tz qx qy qz qw";

bool is_tum(const std::vector<std::string_view>& fields, std::string_view /*head*/) { return fields.size() == 8; }

std::vector<TrajectoryPose> read_tum(const std::filesystem::path& file, std::string_view text, Problems* problems) {
  std::vector<TrajectoryPose> poses;
  for (const auto& [line, n] : number_lines(file, text, 8, kLayout, problems))
    poses.push_back({n[0], {quaternion_of(n[4], n[5], n[6], n[7], file, line, problems), {n[1], n[2], n[3]}}});
  return poses;
}

}  // namespace

TrajectoryFormat tum_trajectory() { return {"tum", kLayout, is_tum, read_tum}; }

}  // namespace rigproof
