// What the files of the Python module share. One file a subject; each declares its classes in a function below.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <Eigen/Core>
#include <array>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/finding.h"
#include "rigproof/core/rigid3.h"

namespace rigproof::python {

namespace py = pybind11;
using namespace py::literals;  // "key"_a

void add_errors(py::module_& module);
void add_geometry(py::module_& module);
void add_inputs(py::module_& module);
void add_results(py::module_& module);
void add_validation(py::module_& module);
void add_work(py::module_& module);
void add_studies(py::module_& module);

/// Any array of numbers, as doubles row by row.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A new array of the matrix: of one dimension for a vector.
template <typename Derived>
py::array_t<double> array_of(const Eigen::MatrixBase<Derived>& matrix) {
  std::vector<py::ssize_t> shape = {matrix.rows()};
  if (Derived::ColsAtCompileTime != 1) shape.push_back(matrix.cols());
  py::array_t<double> array(shape);
  Eigen::Map<RowMajor>(array.mutable_data(), matrix.rows(), matrix.cols()) = matrix;
  return array;
}

/// One row for each element: `row_of(element)` answers a vector of `width`.
template <typename Elements, typename RowOf>
py::array_t<double> rows_of(const Elements& elements, Eigen::Index width, const RowOf& row_of) {
  RowMajor rows(static_cast<Eigen::Index>(elements.size()), width);
  Eigen::Index at = 0;
  for (const auto& element : elements) rows.row(at++) = row_of(element);
  return array_of(rows);
}

/// A list of what `part_of(element)` answers for each element.
template <typename Elements, typename PartOf>
py::list list_of(const Elements& elements, const PartOf& part_of) {
  py::list list;
  for (const auto& element : elements) list.append(part_of(element));
  return list;
}

/// The numbers, with NaN for those that are absent.
template <std::size_t N>
py::array_t<double> array_of(const std::array<std::optional<double>, N>& values) {
  Eigen::Matrix<double, static_cast<int>(N), 1> numbers;
  for (std::size_t i = 0; i < N; ++i) numbers(static_cast<Eigen::Index>(i)) = values[i].value_or(kNaN);
  return array_of(numbers);
}

inline py::array_t<bool> array_of(const std::array<bool, 6>& flags) {
  py::array_t<bool> array(6);
  std::copy(flags.begin(), flags.end(), array.mutable_data());
  return array;
}

/// Throws ValueError unless the array has that shape; -1 is any length.
/// @param finite whether NaN and infinity are refused, too
void check_shape(const Array& array, std::initializer_list<py::ssize_t> shape, const char* name, bool finite = true);

/// A view of an array of one or two dimensions whose shape has been checked.
inline Eigen::Map<const RowMajor> matrix_of(const Array& array) {
  return {array.data(), array.shape(0), array.ndim() > 1 ? array.shape(1) : 1};
}
Vector6d vector6_of(const Array& array, const char* name);
/// Throws ValueError unless it is symmetric with a diagonal that is not negative, to rounding.
Eigen::MatrixXd covariance_of(const Array& array, py::ssize_t size, const char* name);
/// A 4x4 matrix, or a Pose. Throws ValueError for a matrix that is not rigid, TypeError for anything else.
Rigid3 pose_of(const py::handle& pose, const char* name);

/// A getter that answers a copy: what a caller keeps outlives its owner, and changes nothing in it.
template <typename Class, typename Value>
auto copy_of(Value Class::*member) {
  return [member](const Class& object) -> Value { return object.*member; };
}

/// The findings in words.
std::vector<std::string> sentences_of(const std::vector<Finding>& findings);

}  // namespace rigproof::python
