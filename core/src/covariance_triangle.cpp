#include "covariance_triangle.h"

#include <algorithm>
#include <cmath>

namespace rigproof {

std::vector<std::vector<double>> upper_triangle(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& rows) {
  std::vector<std::vector<double>> triangle;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    triangle.emplace_back();
    for (std::size_t j = i; j < rows.size(); ++j) triangle.back().push_back(matrix(rows[i], rows[j]));
  }
  return triangle;
}

bool is_triangle(const std::vector<std::vector<double>>& lines, std::size_t size) {
  std::size_t i = 0;
  return lines.size() == size && std::all_of(lines.begin(), lines.end(), [&](const std::vector<double>& line) {
           return line.size() == size - i++;
         });
}

bool is_covariance(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& rows) {
  bool positive = true;
  for (const Eigen::Index i : rows)
    for (const Eigen::Index j : rows)
      positive = positive && matrix(i, i) >= 0.0 &&
                 std::abs(matrix(i, j)) <= std::sqrt(matrix(i, i) * matrix(j, j)) * (1.0 + 1e-6);
  return positive;
}

}  // namespace rigproof
