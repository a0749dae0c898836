#include "fine_numbers.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace rigproof::ml {
namespace {

// A row for each pixel: what independent numbers of unit variance at the nodes of all grids displace it by.
Eigen::MatrixXd displacements_by_nodes(const Camera& camera, const std::vector<RemovedErrors::Fine::Grid>& grids,
                                       const std::vector<Eigen::Vector2d>& pixels) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(pixels.size()), 0);
  for (const RemovedErrors::Fine::Grid& grid : grids) {
    const FineField field(camera, grid.cells);
    const Eigen::Index first = rows.cols();
    rows.conservativeResize(Eigen::NoChange, first + field.nodes());
    rows.rightCols(field.nodes()).setZero();
    for (std::size_t i = 0; i < pixels.size(); ++i)
      for (const FineField::Share& share : field.at(pixels[i]))
        rows(static_cast<Eigen::Index>(i), first + share.node) = grid.counted_px() * share.weight;
  }
  return rows;
}

// Corners that lie close together, for one of them.
struct CloseCorners {
  Eigen::Vector2d pixel;
  double weight;
};

std::vector<CloseCorners> corners_of(const Observations& observations, int camera, double noise) {
  constexpr double kAcross = 48.0;  // a third of the finest grid's cells
  const Camera& lens = observations.cameras[static_cast<std::size_t>(camera)].camera;
  const double cell_px = std::max(lens.width_px, lens.height_px) / kAcross;
  std::map<std::pair<int, int>, CloseCorners> groups;
  for (const BoardView& view : observations.board_views) {
    if (view.camera != camera) continue;
    for (const CornerObservation& corner : view.corners) {
      const double variance = 0.5 * noise * corner.covariance_px2.trace();
      if (!(variance > 0.0) || !std::isfinite(variance) || !lens.contains(corner.pixel)) continue;
      const std::pair<int, int> cell(static_cast<int>(std::floor(corner.pixel.x() / cell_px)),
                                     static_cast<int>(std::floor(corner.pixel.y() / cell_px)));
      groups.emplace(cell, CloseCorners{corner.pixel, 0.0}).first->second.weight += 1.0 / variance;
    }
  }
  std::vector<CloseCorners> all;
  for (const auto& [cell, group] : groups) all.push_back(group);
  return all;
}

}  // namespace

FineNumbers::FineNumbers(const Camera& camera, const std::vector<RemovedErrors::Fine::Grid>& grids,
                         const std::vector<Eigen::Vector2d>& places) {
  for (const RemovedErrors::Fine::Grid& grid : grids) {
    grids_.push_back({FineField(camera, grid.cells), nodes_, grid.counted_px()});
    nodes_ += grids_.back().field.nodes();
  }
  by_nodes_ = displacements_by_nodes(camera, grids, places);
  const Eigen::MatrixXd covariance = by_nodes_ * by_nodes_.transpose();
  Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL().solveInPlace(by_nodes_);
}

Eigen::VectorXd FineNumbers::at(const Eigen::Vector2d& pixel) const {
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(along_x());
  for_each_node(pixel, [&](int node, double px) { displacement += px * by_nodes_.col(node); });
  return displacement;
}

Eigen::Matrix2Xd FineNumbers::rows(const Eigen::Matrix2d& whitening, const Eigen::VectorXd& by_number) {
  Eigen::Matrix2Xd both(2, 2 * by_number.size());
  both << whitening.col(0) * by_number.transpose(), whitening.col(1) * by_number.transpose();
  return both;
}

Eigen::Vector2d FineNumbers::displacement(const Eigen::Vector2d& pixel, const Eigen::VectorXd& numbers) const {
  const Eigen::VectorXd by_number = at(pixel);
  return {by_number.dot(numbers.head(along_x())), by_number.dot(numbers.tail(along_x()))};
}

FineSquares::FineSquares(const FineNumbers& numbers, std::size_t corners)
    : numbers_(&numbers), sums_nodes_(corners > 2 * static_cast<std::size_t>(numbers.nodes_)) {
  if (sums_nodes_) xx_ = xy_ = yy_ = Eigen::MatrixXd::Zero(numbers.nodes_, numbers.nodes_);
}

void FineSquares::add(const Eigen::Vector2d& pixel, const Eigen::VectorXd& by_number,
                      const Eigen::Matrix2d& information) {
  if (!sums_nodes_) {
    corners_.push_back({by_number, information});
    return;
  }
  near_.clear();
  numbers_->for_each_node(pixel, [this](int node, double px) { near_.emplace_back(node, px); });
  for (std::size_t i = 0; i < near_.size(); ++i)  // nodes come by rising number
    for (std::size_t j = i; j < near_.size(); ++j) {
      const double both = near_[i].second * near_[j].second;
      xx_(near_[j].first, near_[i].first) += both * information(0, 0);
      xy_(near_[j].first, near_[i].first) += both * information(0, 1);
      yy_(near_[j].first, near_[i].first) += both * information(1, 1);
    }
}

Eigen::MatrixXd FineSquares::sum() const { return sums_nodes_ ? sum_of_nodes() : sum_of_corners(); }

Eigen::MatrixXd FineSquares::sum_of_corners() const {
  const Eigen::Index n = numbers_->along_x(), corners = static_cast<Eigen::Index>(corners_.size());
  Eigen::MatrixXd by_numbers(n, corners), informations(corners, 3);
  for (Eigen::Index i = 0; i < corners; ++i) {
    const Corner& corner = corners_[static_cast<std::size_t>(i)];
    by_numbers.col(i) = corner.by_number;
    informations.row(i) << corner.information(0, 0), corner.information(0, 1), corner.information(1, 1);
  }
  const auto weighted = [&](Eigen::Index which) -> Eigen::MatrixXd {
    return by_numbers * informations.col(which).asDiagonal() * by_numbers.transpose();
  };
  Eigen::MatrixXd all(2 * n, 2 * n);
  all.topLeftCorner(n, n) = weighted(0);
  all.bottomLeftCorner(n, n) = weighted(1);
  all.topRightCorner(n, n) = all.bottomLeftCorner(n, n);
  all.bottomRightCorner(n, n) = weighted(2);
  return all;
}

Eigen::MatrixXd FineSquares::sum_of_nodes() const {
  const Eigen::MatrixXd& M = numbers_->by_nodes_;
  const Eigen::Index n = M.rows();
  const auto reduced = [&](const Eigen::MatrixXd& below_diagonal) -> Eigen::MatrixXd {
    const Eigen::MatrixXd by_nodes = below_diagonal.selfadjointView<Eigen::Lower>();
    Eigen::MatrixXd half = Eigen::MatrixXd::Zero(n, by_nodes.cols());
    for (Eigen::Index j = 0; j < by_nodes.cols(); ++j)
      for (Eigen::Index i = 0; i < by_nodes.rows(); ++i)  // nodes far from each other have nothing in common
        if (by_nodes(i, j) != 0.0) half.col(j) += by_nodes(i, j) * M.col(i);
    return half * M.transpose();
  };
  Eigen::MatrixXd all(2 * n, 2 * n);
  all.topLeftCorner(n, n) = reduced(xx_);
  all.bottomLeftCorner(n, n) = reduced(xy_);
  all.topRightCorner(n, n) = all.bottomLeftCorner(n, n);
  all.bottomRightCorner(n, n) = reduced(yy_);
  return all;
}

namespace {

// Cholesky's factorisation of the covariance of the displacements, the largest that is left first.
std::vector<Eigen::Vector2d> places_among_corners(const Observations& observations, int camera,
                                                  const std::vector<RemovedErrors::Fine::Grid>& grids, double noise) {
  constexpr double kLeftOut = 1.0;
  constexpr double kRounding = 1e-9;  // of a pixel's variance
  const std::vector<CloseCorners> groups = corners_of(observations, camera, noise);
  std::vector<Eigen::Vector2d> candidates, places;
  Eigen::VectorXd weight(static_cast<Eigen::Index>(groups.size()));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    candidates.push_back(groups[i].pixel);
    weight[static_cast<Eigen::Index>(i)] = groups[i].weight;
  }
  const Eigen::MatrixXd rows =
      displacements_by_nodes(observations.cameras[static_cast<std::size_t>(camera)].camera, grids, candidates);
  const Eigen::VectorXd variance = rows.rowwise().squaredNorm();
  Eigen::VectorXd left = variance;
  Eigen::MatrixXd factor(rows.rows(), std::min(rows.rows(), rows.cols()));
  for (Eigen::Index k = 0; k < factor.cols() && weight.dot(left) >= kLeftOut; ++k) {
    Eigen::Index next = 0;
    weight.cwiseProduct(left).maxCoeff(&next);
    if (!(left[next] > kRounding * variance[next])) break;
    places.push_back(candidates[static_cast<std::size_t>(next)]);
    factor.col(k) = rows * rows.row(next).transpose() - factor.leftCols(k) * factor.row(next).head(k).transpose();
    factor.col(k) /= std::sqrt(left[next]);
    left = (left - factor.col(k).cwiseAbs2()).cwiseMax(0.0);
    left[next] = 0.0;
  }
  return places;
}

}  // namespace

std::shared_ptr<const FineNumbers> numbers_for(const Observations& observations, int camera,
                                               const std::vector<RemovedErrors::Fine::Grid>& grids, double noise) {
  const std::vector<Eigen::Vector2d> places = places_among_corners(observations, camera, grids, noise);
  if (places.empty()) return nullptr;
  return std::make_shared<const FineNumbers>(observations.cameras[static_cast<std::size_t>(camera)].camera, grids,
                                             places);
}

}  // namespace rigproof::ml
