// The normalised errors of many robots together.
#pragma once

#include <cstdio>
#include <string>

#include "rigproof/core/chi_square.h"

namespace rigproof::bench {

struct NeesPool {
  double nees = 0.0;
  int unknowns = 0, runs = 0;

  void add(double run_nees, int run_unknowns) {
    nees += run_nees;
    unknowns += run_unknowns;
    ++runs;
  }
};

/// Whether it lies where 99 of 100 true ones do.
inline bool print_pool(const std::string& name, const NeesPool& pool) {
  if (pool.unknowns == 0) return true;
  const double low = chi_square_quantile(0.005, pool.unknowns) / pool.unknowns,
               high = chi_square_quantile(0.995, pool.unknowns) / pool.unknowns, ratio = pool.nees / pool.unknowns;
  std::printf("%-12s %3d robots, %4d unknowns: NEES over them %.3f (99 %%: %.3f to %.3f)\n", name.c_str(), pool.runs,
              pool.unknowns, ratio, low, high);
  return ratio >= low && ratio <= high;
}

}  // namespace rigproof::bench
