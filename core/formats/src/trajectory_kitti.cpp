// KITTI odometry: a 3x4 matrix a line, of the left camera (x right, y down, z forward); times.txt beside has the
// stamps.
#include <cmath>

#include "rigproof/core/files.h"
#include "rigproof/formats/trajectory.h"

namespace rigproof {
namespace {

constexpr const char* kLayout = "the twelve numbers of a 3x4 matrix, with stamps in times.txt beside it";

bool is_kitti(const std::vector<std::string_view>& fields, std::string_view /*head*/) { return fields.size() == 12; }

// x forward, y left, z up, of axes x right, y down, z forward.
Rigid3 body_from_camera_axes() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {Eigen::Quaterniond(R), Eigen::Vector3d::Zero()};
}

std::vector<TrajectoryPose> read_kitti(const std::filesystem::path& file, std::string_view text, Problems* problems) {
  const std::vector<NumberLine> matrices = number_lines(file, text, 12, kLayout, problems);
  const std::filesystem::path times = file.parent_path() / "times.txt";
  const std::string times_text = read_text_file(times);
  const std::vector<NumberLine> stamps = number_lines(times, times_text, 1, "one stamp in seconds", problems);
  if (stamps.size() != matrices.size() && problems->empty())
    problems->add(
        {times.string(), 0, "", "",
         "has " + std::to_string(stamps.size()) + " stamps for " + std::to_string(matrices.size()) + " poses"});
  const Rigid3 B = body_from_camera_axes();
  std::vector<TrajectoryPose> poses;
  for (std::size_t i = 0; i < std::min(stamps.size(), matrices.size()); ++i) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    for (int k = 0; k < 12; ++k) T(k / 4, k % 4) = matrices[i].numbers[static_cast<std::size_t>(k)];
    if (const double determinant = T.topLeftCorner<3, 3>().determinant(); !(std::abs(determinant - 1.0) < 0.01)) {
      problems->add({file.string(), matrices[i].line, "", "",
                     "is no rotation: its determinant is " + std::to_string(determinant)});
      break;
    }
    poses.push_back({stamps[i].numbers[0], B * Rigid3::from_matrix(T) * B.inverse()});
  }
  return poses;
}

}  // namespace

TrajectoryFormat kitti_trajectory() { return {"kitti", kLayout, is_kitti, read_kitti}; }

}  // namespace rigproof
