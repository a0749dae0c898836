// Intrinsics as ROS has them in sensor_msgs/CameraInfo: in messages, and in the files of calibrators.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/camera.h"
#include "rigproof/core/error.h"

namespace rigproof {

struct CameraInfo {
  std::uint32_t height = 0, width = 0;  ///< of the full sensor, before binning and the region of interest
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{};  ///< row-major, of the full sensor
  std::array<double, 9> r{};
  std::array<double, 12> p{};                  ///< row-major, of the rectified image
  std::uint32_t binning_x = 0, binning_y = 0;  ///< 0 and 1: none
  struct Region {
    std::uint32_t x_offset = 0, y_offset = 0, height = 0, width = 0;  ///< of the full sensor; size 0: all of it
  } roi;
};

/// Without the name of the topic or file.
class CameraInfoError : public Error {
 public:
  CameraInfoError(std::string field, const std::string& message) : Error(message), field_(std::move(field)) {}
  const std::string& field() const { return field_; }  ///< as CameraInfo calls it

 private:
  std::string field_;
};

struct InfoReading {
  Camera camera;
  std::vector<std::string> notes;  ///< what was approximated or assumed
  /// k1 k2 p1 p2 k3 k4 k5 k6, where no lens of ours meets them: images have to be rectified to be the camera's.
  std::vector<double> to_undo;
};

/// The camera of the images that go with a CameraInfo: K and D, or P without distortion for rectified images, after
/// binning (super-pixels, as the message's definition says) and the region of interest. rational_polynomial is fitted
/// by one of our lenses where that is possible to a quarter of a pixel, else it is to be undone. Throws CameraInfoError
/// for what is no calibration and for lenses that we do not have.
InfoReading camera_of_info(const CameraInfo& info, bool rectified);

/// The same of a YAML file: what camera_calibration and `ros2 topic echo` write, and OpenCV's FileStorage. Other keys
/// are left alone. Empty where problems were added. Throws Error for what is no YAML.
std::optional<InfoReading> read_camera_info(const std::filesystem::path& file, bool rectified, Problems* problems);

}  // namespace rigproof
