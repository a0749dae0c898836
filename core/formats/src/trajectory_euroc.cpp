// The EuRoC MAV data set's ground truth: nanoseconds, and w first in the quaternion.
#include "rigproof/formats/trajectory.h"

namespace rigproof {
namespace {

constexpr const char* kLayout = "stamp_ns,tx,ty,tz,qw,qx,qy,qz";

// Stamps of nanoseconds have 16 digits and more, and no point.
bool is_euroc(const std::vector<std::string_view>& fields, std::string_view head) {
  const bool nanoseconds = fields.front().size() >= 16 && fields.front().find('.') == std::string_view::npos;
  return fields.size() >= 8 && head.find(',') != std::string_view::npos && nanoseconds;
}

std::vector<TrajectoryPose> read_euroc(const std::filesystem::path& file, std::string_view text, Problems* problems) {
  std::vector<TrajectoryPose> poses;
  for (const auto& [line, n] : number_lines(file, text, 8, kLayout, problems))
    poses.push_back({1e-9 * n[0], {quaternion_of(n[5], n[6], n[7], n[4], file, line, problems), {n[1], n[2], n[3]}}});
  return poses;
}

}  // namespace

TrajectoryFormat euroc_trajectory() { return {"euroc", kLayout, is_euroc, read_euroc}; }

}  // namespace rigproof
