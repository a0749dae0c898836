// YAML of OpenCV's FileStorage: intrinsics and T_robot_camera of each camera.
#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>

#include "comments.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

cv::Mat matrix_of(const Eigen::MatrixXd& values) {
  cv::Mat matrix(static_cast<int>(values.rows()), static_cast<int>(values.cols()), CV_64F);
  for (int row = 0; row < matrix.rows; ++row)
    for (int column = 0; column < matrix.cols; ++column) matrix.at<double>(row, column) = values(row, column);
  return matrix;
}

void write_camera(cv::FileStorage& storage, const ExportCamera& camera) {
  const Camera& lens = *camera.intrinsics();
  const bool fisheye = lens.lens == Lens::kKannalaBrandt;
  Eigen::MatrixXd coefficients(1, fisheye ? 4 : 5);
  for (Eigen::Index i = 0; i < coefficients.cols(); ++i)
    coefficients(0, i) = lens.distortion[static_cast<std::size_t>(i)];
  storage << "{"
          << "name" << camera.name << "image_width" << lens.width_px << "image_height" << lens.height_px
          << "camera_matrix" << matrix_of(lens.matrix()) << "distortion_model" << (fisheye ? "fisheye" : "plumb_bob")
          << "distortion_coefficients" << matrix_of(coefficients);
  if (camera.is_known())
    storage << "parent" << camera.estimate.parent << "T_parent_camera"
            << matrix_of(camera.estimate.T_parent_child.matrix());
  storage << "}";
}

// Names of cameras are no keys here: FileStorage's begin with a letter.
ExportOutput write(const ExportJob& job) {
  cv::FileStorage storage(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  for (const std::string& line : exporting::head_lines(job)) storage.writeComment(line);
  storage << "cameras"
          << "[";
  for (const ExportCamera& camera : job.cameras) write_camera(storage, camera);
  storage << "]";
  return {{{"", storage.releaseAndGetString()}}, {}};
}

}  // namespace

ExportFormat opencv_export() {
  ExportFormat format;
  format.name = "opencv";
  format.what = "YAML of OpenCV's FileStorage: intrinsics and T_parent_camera of the optical frames";
  format.is_tree = false;
  format.needs_intrinsics = true;
  format.write = write;
  return format;
}

}  // namespace rigproof
