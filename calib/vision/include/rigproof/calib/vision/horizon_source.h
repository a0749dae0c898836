// The horizon and the forward direction in a single image, from an exchangeable source.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "rigproof/core/image.h"

namespace rigproof {

/// In pixels of the image as it is, distorted; places may lie outside of it.
struct HorizonSight {
  std::optional<Eigen::Vector2d> ahead_px;                   ///< where lines along the robot's way meet
  std::optional<std::array<Eigen::Vector2d, 2>> horizon_px;  ///< two places on it, the left one first
};

/// Implementations may be called from several threads at once.
class HorizonSource {
 public:
  virtual ~HorizonSource() = default;
  /// Deterministic. The picture is taken to be upright: up in the image is up in the world, more or less.
  virtual HorizonSight look(const Image8& grey) const = 0;
};

/// A network in ONNX through OpenCV's dnn module. Input 1 x 3 x 512 x 512: the whole image, stretched, grey in [0, 1]
/// in all three channels. Outputs, either or both: two numbers, the vanishing point of the way ahead (x, y), and three,
/// the horizon a x + b y + c = 0, with x and y from -1 (the left and upper edge of the image) to 1. Throws Error if the
/// file is no such network.
std::unique_ptr<HorizonSource> dnn_horizon(const std::filesystem::path& onnx_file);

/// "onnx:FILE". Throws Error for anything else, and as dnn_horizon().
std::unique_ptr<HorizonSource> horizon_source_by_name(const std::string& name);

}  // namespace rigproof
