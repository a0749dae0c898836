// Robots that nobody here built: lenses, board and depth differ from what is stated by errors drawn from the usual
// priors, all at once. They drive without pictures, as geometric runs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "rigproof/calib/estimate/lens_change.h"
#include "rigproof/geometric/geometric.h"

namespace rigproof {

/// What is worse than usual of one thing, as a multiple of its prior; and a depth camera that measures too far.
struct Worse {
  double field = 1.0, print = 1.0, depth_offset_m = 0.0;
  double cells = 0.0;  ///< of the grid of the lenses' fields; 0: waves
};

/// How fine the field of a lens is nobody states: of three robots one has waves, two have a lattice of 8 to 16 cells
/// across the image.
Worse of_any_scale(int seed);

struct Stranger {
  GeometricConfig config;  ///< the rig as it is
  GeometricRig told;       ///< the rig as its files say
  std::vector<ml::LensChange> lens;
  Eigen::Vector4d board;               ///< its size, ratio and bow along x and y
  std::vector<Eigen::Vector3d> print;  ///< where each corner lies against all of these [board frame, m]
  std::vector<Eigen::Vector3d> depth;  ///< of each camera: offset, tilt about x and y
  std::vector<Vector6d> shape;         ///< of each depth image: its shift along x and y [tan], and what lenses leave
  using Field = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;
  std::vector<Field> fields;  ///< what no coefficients of a lens follow, by the pixel [px], of each camera
};

/// The cameras and the board are other ones than the rig says.
Stranger draw_stranger(int seed, double corner_sigma_px = 0.1, const Worse& worse = {});

/// True minus stated of each corner: by the shape of the board, and by print.
std::vector<Eigen::Vector3d> print_errors_m(const Board& board, const Eigen::Vector4d& shape,
                                            const std::vector<Eigen::Vector3d>& print);

/// One drive of it: what is observed has the errors of its lenses, board and depth, and says what the files say.
GeometricRun drive(const Stranger& robot, std::uint64_t seed, int stops);
/// The same of a run of its true cameras and board.
Observations as_told(const Stranger& robot, Observations observations);

}  // namespace rigproof
