#include "numbers.h"

#include "rigproof/core/body_axes.h"
#include "rigproof/core/text.h"

namespace rigproof::exporting {

std::string decimal_text(double value) {
  std::string text = fixed_text(value, 10);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string vector_text(const Eigen::Vector3d& values) {
  return decimal_text(values.x()) + " " + decimal_text(values.y()) + " " + decimal_text(values.z());
}

Rigid3 UrdfPose::transform() const { return {from_roll_pitch_yaw(rpy_rad), xyz_m}; }

UrdfPose urdf_pose(const Rigid3& T) { return {T.translation, roll_pitch_yaw(T.rotation)}; }

Rigid3 body_from_optical() { return {optical_from_body().conjugate(), Eigen::Vector3d::Zero()}; }

std::string matrix_text(const Eigen::Matrix4d& matrix) {
  std::string text;
  for (Eigen::Index row = 0; row < 4; ++row) {
    for (Eigen::Index column = 0; column < 4; ++column)
      text += (column == 0 ? "" : " ") + number_text(matrix(row, column));
    text += "\n";
  }
  return text;
}

}  // namespace rigproof::exporting
