// Covariances as files hold them: rows from the diagonal on.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace rigproof {

/// Row by row from the diagonal on, only the rows and columns given.
std::vector<std::vector<double>> upper_triangle(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& rows);
bool is_triangle(const std::vector<std::vector<double>>& lines, std::size_t size);
/// Whether in these rows variances are not negative, and correlations at most 1.
bool is_covariance(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& rows);

}  // namespace rigproof
