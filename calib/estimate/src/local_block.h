// One block of residuals: its part of the normal equations on the few unknowns that it depends on.
#pragma once

#include <Eigen/Core>
#include <array>

#include "rigproof/calib/estimate/group_sums.h"
#include "rigproof/calib/estimate/residuals.h"

namespace rigproof::ml {

/// Some unknowns of one pose, or globals where `pose` is -1.
struct Segment {
  int pose, offset, size;
};
inline Segment of_pose(int pose, int offset = 0, int size = 6) { return {pose, offset, size}; }
inline Segment of_globals(int offset, int size) { return {-1, offset, size}; }

struct LocalBlock {
  static constexpr int kMaxUnknowns = 40, kMaxSegments = 11;
  using Rows = RowJacobian<3, kMaxUnknowns>;

  LocalBlock(Group group_of, int camera_of) : group(group_of), camera(camera_of) {}

  Group group;
  int camera;
  double cost = 0.0;
  GroupSum sum;
  std::array<Segment, kMaxSegments> segments;
  std::array<int, kMaxSegments> starts;  ///< of each segment in H and g
  int count = 0, unknowns = 0;
  /// Only of these unknowns; of H the segments' blocks on and below the diagonal.
  Eigen::Matrix<double, kMaxUnknowns, kMaxUnknowns> H;
  Eigen::Matrix<double, kMaxUnknowns, 1> g;

  /// Returns where the segment begins. Throws Error where there is no room.
  int append(const Segment& segment);
  /// The same for a nuisance; -1 where it is believed.
  int append(const Layout& layout, Nuisance nuisance, int camera = 0);
};

/// Up to three residuals with their derivatives by the unknowns of a block.
class BlockRows {
 public:
  explicit BlockRows(LocalBlock* block) : block_(*block) {}

  /// Appends unknowns with their derivative, one column each.
  template <typename Derivative>
  void add(const Segment& segment, const Derivative& derivative) {
    set(block_.append(segment), derivative);
  }
  template <typename Derivative>
  void add(const Layout& layout, Nuisance nuisance, int camera, const Derivative& derivative) {
    set(block_.append(layout, nuisance, camera), derivative);
  }
  void whiten(const Eigen::Matrix3d& whitening);
  /// Fills the block's H and g with the part that the share has of the residuals r.
  void set_normal(const Eigen::Matrix3d& share, const Eigen::Vector3d& r, double factor) const;
  /// The same of all.
  void set_normal(const Eigen::Vector3d& r, double factor) const;

 private:
  template <typename Derivative>
  void set(int start, const Derivative& derivative) {
    if (start >= 0) J_.middleCols<Derivative::ColsAtCompileTime>(start) = derivative;
  }

  LocalBlock& block_;
  LocalBlock::Rows J_;
};

class BlockSink {
 public:
  virtual ~BlockSink() = default;
  virtual void add(const LocalBlock& block) = 0;
};

/// Where two segments meet in a matrix with the shape of an ArrowSystem: element (i, j) is data[i * row + j * column],
/// and one of the two is 1.
template <typename Scalar>
struct Meeting {
  Scalar* data;
  Eigen::Index row, column;
};
/// Any matrix of that shape: P(i, i), P(i, i - 1), U by rows, C.
template <typename Matrix6, typename Scalar>
struct ArrowBlocks {
  Matrix6* diagonal;
  Matrix6* coupling;
  Scalar* pose_global;
  Scalar* global;
  Eigen::Index globals;

  /// Of the globals the part below the diagonal. Of two poses b is the one before a.
  Meeting<Scalar> at(const Segment& a, const Segment& b) const {
    if (a.pose < 0 && b.pose < 0)
      return a.offset < b.offset ? Meeting<Scalar>{global + b.offset + a.offset * globals, globals, 1}
                                 : Meeting<Scalar>{global + a.offset + b.offset * globals, 1, globals};
    if (b.pose < 0) return {pose_global + (6 * a.pose + a.offset) * globals + b.offset, globals, 1};
    if (a.pose < 0) return {pose_global + (6 * b.pose + b.offset) * globals + a.offset, 1, globals};
    Matrix6& P = (a.pose == b.pose ? diagonal : coupling)[a.pose];
    return {P.data() + a.offset + 6 * b.offset, 1, 6};
  }
};

}  // namespace rigproof::ml
