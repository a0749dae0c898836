// Draws a World's geometry into off-screen buffers through exact frusta, and reads them back.
#pragma once

#include <cstdint>
#include <vector>

#include "egl_context.h"
#include "mujoco_compat.h"
#include "resample.h"
#include "rigproof/sim/world.h"

namespace rigproof {

/// Slopes (x/z, y/z) of the four sides of a frustum, y down, and the picture's size. Pixels must come out square:
/// (x_max - x_min) / width = (y_max - y_min) / height.
struct Frustum {
  double x_min = 0.0, x_max = 0.0, y_min = 0.0, y_max = 0.0;
  int width = 0, height = 0;
};

/// Where a picture is drawn.
struct RenderTarget {
  unsigned int framebuffer = 0, color = 0, depth = 0;
  int width = 0, height = 0;
};

/// What a pass shows.
enum class Pass { kColor, kObjectIds };

/// One context with MuJoCo's buffers of a World, and render targets that grow as needed.
class GlScene {
 public:
  GlScene(World& world, int device);
  ~GlScene();
  GlScene(const GlScene&) = delete;
  GlScene& operator=(const GlScene&) = delete;

  /// Takes over the state of the world and looks at it from T_world_camera. Ceilings can be left out.
  void look_from(const Rigid3& T_world_camera, bool with_ceiling = true);
  /// Draws; the reads below then hand over this picture.
  void draw(const Frustum& frustum, Pass pass);
  /// RGBA of the last draw, alpha 0 where there is nothing; valid until the next read.
  RgbaView read_color();
  /// The memory of the last read, bottom row first.
  std::uint8_t* color_rows_from_bottom() { return color_pixels_.data(); }
  /// Window depth (24 bits) and stencil (8 bits) of the last draw, bottom row first; valid until the next read.
  const std::uint32_t* read_depth();
  /// The memory of the last read, bottom row first.
  std::uint32_t* depth_rows_from_bottom() { return depth_pixels_.data(); }
  /// Maps the number that a pixel of the kObjectIds pass encodes to the id of World::kind_of_object().
  const std::vector<std::uint16_t>& object_of_segment() const { return object_of_segment_; }
  const mujoco::DepthLaw& depth_law() const { return depth_law_; }
  const EglContext& context() const { return context_; }
  /// Waits for the driver; for benchmarks.
  void finish() const;

 private:
  void make_targets(int width, int height);
  void centre_on(const Eigen::Vector3d& camera);

  EglContext context_;
  World& world_;
  mjvScene scene_{};
  mjrContext buffers_{};
  mjvOption visible_{};
  unsigned int own_framebuffer_ = 0;  // the one that MuJoCo made and frees
  RenderTarget target_;
  int max_size_ = 0;
  Frustum last_;
  mujoco::DepthLaw depth_law_;
  std::vector<std::uint8_t> color_pixels_;
  std::vector<std::uint32_t> depth_pixels_;
  std::vector<std::uint16_t> object_of_segment_;
};

}  // namespace rigproof
