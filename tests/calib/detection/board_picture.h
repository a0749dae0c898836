// Pictures of checkerboards, ChArUco boards and AprilGrids made from formulas alone, independent of any renderer, to
// test the detector against.
#pragma once

#include <cstdint>
#include <vector>

#include "rigproof/core/board.h"
#include "rigproof/core/camera.h"
#include "rigproof/core/image.h"
#include "rigproof/core/rigid3.h"

namespace rigproof {

struct BoardPictureOptions {
  double psf_sigma_px = 0.6;
  int supersampling = 4;  ///< samples a pixel along each axis; edges are area-sampled within each sample
  double dark = 40.0;     ///< grey levels
  double light = 215.0;
  bool point_samples =
      false;           ///< edges are not area-sampled: each sample is light or dark, as a plain ray-caster has it
  double bow_m = 0.0;  ///< the middle of the sheet stands out towards the viewer, bent about the board's y
  double corner_light = 1.0;  ///< in the image's corner over that in its middle: 1 / (1 + k r^2)^2
  double noise_sigma = 0.0;   ///< grey levels, white
  double slope_per_px = 0.0;  ///< relative change of the light along x and y
  double border_m = 0.05;     ///< white margin around the squares
  /// Something of the background's grey hides these columns of squares, from .. to [squares from the board's edge].
  double hidden_from_x = 0.0, hidden_to_x = 0.0;
  int tag_border_bits = 2;  ///< of an AprilGrid
  bool clutter = false;     ///< rectangles, a fine checker texture and speckle behind the board
  double background = 120.0;
  std::uint64_t seed = 0;  ///< of noise and clutter
};

/// The board seen from a camera: exact perspective and lens, area sampling, Gaussian lens blur, noise, 8 bit.
Image8 draw_board(const Camera& camera, const Board& board, const Rigid3& T_camera_board,
                  const BoardPictureOptions& options = {});

/// True corners in the image, by id. Empty if one of them does not project.
std::vector<Eigen::Vector2d> true_corners(const Camera& camera, const Board& board, const Rigid3& T_camera_board,
                                          const BoardPictureOptions& options = {});

/// The board's centre at `distance_m` along the ray of `pixel`, its normal at `obliquity_rad` from that ray, tilted
/// about an axis across the ray at angle `axis_rad`, turned in its own plane by `roll_rad`.
Rigid3 board_in_view(const Camera& camera, const Board& board, double distance_m, double obliquity_rad, double axis_rad,
                     double roll_rad, const Eigen::Vector2d& pixel);

}  // namespace rigproof
