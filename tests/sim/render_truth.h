// How far a rendered view is from the truth, measured without any detector.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/random.h"
#include "rigproof/sim/renderer.h"

namespace rigproof {

/// Sums of the shifts of rendered corners against their analytic pictures.
struct ShiftStatistics {
  std::size_t corners = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Vector2d sum_of_squares = Eigen::Vector2d::Zero();
  double largest_px = 0.0;

  void add(const Eigen::Vector2d& shift_px);
  Eigen::Vector2d bias_px() const { return sum / static_cast<double>(corners); }
  Eigen::Vector2d rms_px() const { return (sum_of_squares / static_cast<double>(corners)).cwiseSqrt(); }
};

/// Least-squares shift (Lucas-Kanade) of the corner in the image against the analytic picture of two crossing edges:
/// integrated over each pixel and blurred with the PSF. Empty where the window does not fit or shows other edges.
std::optional<Eigen::Vector2d> corner_shift(const Image8& color, const Camera& camera, const Rigid3& T_camera_board,
                                            const Board& board, int corner, double psf_sigma_px);

/// Largest and root mean square difference of the depth image to the plane z = 0 of `T_camera_plane`, over pixels of
/// the given kind whose neighbours are of the same kind, between 0.4 and 4 m, and within `limits` on the plane.
struct DepthStatistics {
  std::size_t pixels = 0;
  double sum_of_squares_m2 = 0.0;
  double largest_m = 0.0;

  double rms_m() const { return std::sqrt(sum_of_squares_m2 / static_cast<double>(pixels)); }
};
void add_plane_depth(const World& world, const RenderedView& view, ObjectKind kind, const Camera& camera,
                     const Rigid3& T_camera_plane, const Eigen::AlignedBox2d& limits, DepthStatistics* statistics);
/// The printed face without its rim, behind which oblique views see the board's sides; and a floor without end.
Eigen::AlignedBox2d printed_face(const Board& board);
Eigen::AlignedBox2d boundless();

/// A camera pose from which the whole board is well in the image, up to 60 degrees oblique and 4 m away.
Rigid3 random_view_of_board(const Camera& camera, const Board& board, const Rigid3& T_world_board,
                            RandomStream* random);

/// The camera models on which figures are given: symmetric, off-centre, fx != fy, Brown-Conrady, Kannala-Brandt.
std::vector<WorldCamera> figure_cameras();

/// Moves the robot such that one of its cameras is at the given place.
void place_camera(World* world, std::size_t camera, const Rigid3& T_world_camera);

/// The indoor lab with these cameras and a board that stands free.
WorldDescription figure_world(std::vector<WorldCamera> cameras);

}  // namespace rigproof
