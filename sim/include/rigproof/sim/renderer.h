// Renders the cameras of a World off-screen through EGL with exact intrinsics.
#pragma once

#include <memory>
#include <string>

#include "rigproof/core/image.h"
#include "rigproof/sim/exposure.h"
#include "rigproof/sim/render_device.h"
#include "rigproof/sim/world.h"

namespace rigproof {

struct RenderOptions {
  int device = -2;               ///< -2 = first hardware device, else software; -1 = surfaceless Mesa; else EGL index
  double psf_sigma_px = 0.6;     ///< lens blur, standard deviation in pixels of the final image; 0 = none
  bool board_at_double = true;   ///< the board's region is rendered again at 2x and area-averaged
  bool whole_at_double = false;  ///< everything at 2x (slower)
  bool color = true;
  bool depth = true;
  bool object_ids = false;
};

/// What one camera sees. Absent parts are empty.
struct RenderedView {
  Image8 color;        ///< RGB, the camera's size, lens applied
  ImageF depth_m;      ///< z along the optical axis; 0 = beyond the far plane. Of the depth camera where it has its own
  Image8 imager;       ///< what a depth camera of its own sees, one channel (green), of the size of `depth_m`
  Image16 object_ids;  ///< World::kind_of_object() tells what they are; 0 = nothing
};

/// Owns the EGL context; lives and is used in one thread. Several processes render in parallel better than threads.
class Renderer {
 public:
  /// Throws Error that says what is missing and what to install.
  Renderer(World& world, const RenderOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Renders the world as it is now. Bit-identical for the same state, driver and options.
  void render(std::size_t camera, RenderedView* view);
  /// Renders what the camera records while the robot moves: the mean of pictures of every part of the exposure, each
  /// row over its own time, in linear light. Depth is that of each row's time. One part gives what render() gives
  /// there. Places the robot; object ids are not drawn. Throws Error if depth is to be a mean.
  void render_moving(std::size_t camera, const Exposure& color, const Exposure& depth, RenderedView* view);
  /// Renders what a camera that belongs to no robot sees, e.g. from above; without the ceiling if asked.
  void render_from(const Rigid3& T_world_camera, const Camera& camera, bool with_ceiling, RenderedView* view);
  /// The bare passes alone, rendered and read back without resampling: the denominator of throughput benchmarks.
  void render_bare(std::size_t camera);
  /// GL_RENDERER, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
  const std::string& gl_renderer() const;
  /// GL_VERSION.
  const std::string& gl_version() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigproof
