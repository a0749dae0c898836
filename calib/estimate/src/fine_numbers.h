// The fine field of a lens as unknowns: as few numbers as its corners tell apart.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "fine_field.h"
#include "rigproof/calib/estimate/repeating_errors.h"

namespace rigproof::ml {

/// Numbers of unit variance that displace pixels as the independent numbers of all grids do: first those along x, then
/// as many along y. The field at places that stand for all corners makes them (inducing points; Quinonero-Candela and
/// Rasmussen 2005), and what lies between them is what the grids expect there.
class FineNumbers {
 public:
  /// @param places where the field is taken for unknown
  FineNumbers(const Camera& camera, const std::vector<RemovedErrors::Fine::Grid>& grids,
              const std::vector<Eigen::Vector2d>& places);

  int size() const { return 2 * along_x(); }
  int along_x() const { return static_cast<int>(by_nodes_.rows()); }
  /// What one of each number displaces a pixel by [px]: along x, and the same of those along y.
  Eigen::VectorXd at(const Eigen::Vector2d& pixel) const;
  /// Two rows by all numbers, of a pixel's displacement.
  static Eigen::Matrix2Xd rows(const Eigen::Matrix2d& whitening, const Eigen::VectorXd& by_number);
  /// [px]
  Eigen::Vector2d displacement(const Eigen::Vector2d& pixel, const Eigen::VectorXd& numbers) const;

 private:
  friend class FineSquares;
  struct OfGrid {
    FineField field;
    int first;  // of its nodes
    double sigma_px;
  };
  // visit(node, displacement by one of its numbers [px])
  template <typename Visit>
  void for_each_node(const Eigen::Vector2d& pixel, const Visit& visit) const {
    for (const OfGrid& grid : grids_)
      for (const FineField::Share& share : grid.field.at(pixel))
        visit(grid.first + share.node, grid.sigma_px * share.weight);
  }

  std::vector<OfGrid> grids_;
  int nodes_ = 0;
  Eigen::MatrixXd by_nodes_;  // a row for each number along x
};
/// For all corners of a camera: what the numbers leave out of the field makes the squares of the corners, whitened,
/// larger by less than one in each coordinate. Null where there is no grid or no corner.
/// @param noise variance of the corners, as a multiple of what is stated
std::shared_ptr<const FineNumbers> numbers_for(const Observations& observations, int camera,
                                               const std::vector<RemovedErrors::Fine::Grid>& grids, double noise);

/// What corners tell of the numbers: of many corners summed by nodes, of which each corner is near a few only.
class FineSquares {
 public:
  /// @param corners how many, about
  FineSquares(const FineNumbers& numbers, std::size_t corners);
  /// @param by_number what numbers displace the pixel by (FineNumbers::at)
  /// @param information of the pixel's displacement [1 / px^2]
  void add(const Eigen::Vector2d& pixel, const Eigen::VectorXd& by_number, const Eigen::Matrix2d& information);
  /// Of the numbers.
  Eigen::MatrixXd sum() const;

 private:
  struct Corner {
    Eigen::VectorXd by_number;
    Eigen::Matrix2d information;
  };
  Eigen::MatrixXd sum_of_corners() const;
  Eigen::MatrixXd sum_of_nodes() const;

  const FineNumbers* numbers_;
  bool sums_nodes_;
  std::vector<Corner> corners_;
  std::vector<std::pair<int, double>> near_;  // nodes of the pixel at hand, and their displacements
  Eigen::MatrixXd xx_, xy_, yy_;              // by nodes; below the diagonal
};

}  // namespace rigproof::ml
