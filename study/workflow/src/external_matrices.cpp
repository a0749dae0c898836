#include "external_matrices.h"

#include <Eigen/LU>
#include <algorithm>
#include <optional>

#include "rigproof/core/text.h"

namespace rigproof {
namespace {

constexpr double kRotationTolerance = 1e-3;

using Row = std::vector<double>;

// The numbers at the end of a line; none where anything but numbers follows the first one.
Row row_of(std::string line) {
  std::replace_if(
      line.begin(), line.end(), [](char c) { return std::string("[](){},;\t\r").find(c) != std::string::npos; }, ' ');
  Row row;
  for (std::size_t at = line.find_first_not_of(' '); at != std::string::npos; at = line.find_first_not_of(' ', at)) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    const auto number = parse_number(std::string_view(line).substr(at, end - at));
    if (number)
      row.push_back(*number);
    else if (!row.empty())
      return {};
    at = end;
  }
  return row;
}

std::optional<Rigid3> transform_of(const std::vector<Row>& rows, std::size_t first) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (std::size_t r = 0; r < 3; ++r) {
    if (first + r >= rows.size() || rows[first + r].size() != 4) return std::nullopt;
    for (std::size_t c = 0; c < 4; ++c)
      matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = rows[first + r][c];
  }
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off < kRotationTolerance) || !(R.determinant() > 0.0)) return std::nullopt;
  return Rigid3::from_matrix(matrix);
}

}  // namespace

std::vector<Rigid3> find_matrices(const std::string& text) {
  std::vector<Row> rows;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    rows.push_back(row_of(text.substr(at, end - at)));
    at = end + 1;
  }
  std::vector<Rigid3> transforms;
  for (std::size_t i = 0; i < rows.size();) {
    const std::optional<Rigid3> transform = transform_of(rows, i);
    if (!transform) {
      ++i;
      continue;
    }
    transforms.push_back(*transform);
    i += 3;
    if (i < rows.size() && rows[i] == Row{0.0, 0.0, 0.0, 1.0}) ++i;
  }
  return transforms;
}

}  // namespace rigproof
