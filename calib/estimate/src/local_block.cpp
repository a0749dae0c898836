#include "local_block.h"

#include "rigproof/core/error.h"

namespace rigproof::ml {

int LocalBlock::append(const Segment& segment) {
  if (count == kMaxSegments || unknowns + segment.size > kMaxUnknowns)
    throw Error("estimate: a block of residuals depends on too many unknowns");
  const int start = unknowns;
  segments[static_cast<std::size_t>(count)] = segment;
  starts[static_cast<std::size_t>(count)] = start;
  ++count;
  unknowns += segment.size;
  return start;
}

int LocalBlock::append(const Layout& layout, Nuisance nuisance, int of_camera) {
  return layout.has(nuisance) ? append(of_globals(layout.place(nuisance, of_camera), row_of(nuisance).size())) : -1;
}

void BlockRows::whiten(const Eigen::Matrix3d& whitening) {
  const Eigen::Matrix3d& W = whitening;
  for (int j = 0; j < block_.unknowns; ++j) {
    const double a = J_(0, j), b = J_(1, j), c = J_(2, j);
    for (int k = 0; k < 3; ++k) J_(k, j) = W(k, 0) * a + W(k, 1) * b + W(k, 2) * c;
  }
}

// Plain loops over rows that lie together: compilers make vectors of them, whatever the number of unknowns.
void BlockRows::set_normal(const Eigen::Matrix3d& share, const Eigen::Vector3d& r, double factor) const {
  const int n = block_.unknowns;
  LocalBlock::Rows weighted;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < n; ++i) weighted(k, i) = factor * J_(k, i);
  const double *w0 = &weighted(0, 0), *w1 = &weighted(1, 0), *w2 = &weighted(2, 0);
  const Eigen::Vector3d shared_r = share * r;
  for (int j = 0, first = 0, segment = 0; j < n; ++j) {
    if (segment + 1 < block_.count && j == block_.starts[static_cast<std::size_t>(segment) + 1]) {
      first = j;
      ++segment;
    }
    const double a = J_(0, j), b = J_(1, j), c = J_(2, j);
    const double s0 = share(0, 0) * a + share(0, 1) * b + share(0, 2) * c;
    const double s1 = share(1, 0) * a + share(1, 1) * b + share(1, 2) * c;
    const double s2 = share(2, 0) * a + share(2, 1) * b + share(2, 2) * c;
    double* column = &block_.H(0, j);
    for (int i = first; i < n; ++i) column[i] = w0[i] * s0 + w1[i] * s1 + w2[i] * s2;
    block_.g[j] = w0[j] * shared_r[0] + w1[j] * shared_r[1] + w2[j] * shared_r[2];
  }
}

void BlockRows::set_normal(const Eigen::Vector3d& r, double factor) const {
  set_normal(Eigen::Matrix3d::Identity(), r, factor);
}

}  // namespace rigproof::ml
