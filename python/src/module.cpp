// The compiled half of the Python package `rigproof`: errors, and what the bindings share.
#include <cmath>

#include "bindings.h"
#include "rigproof/core/error.h"
#include "rigproof/core/version.h"
#include "rigproof/words/sentences.h"

namespace rigproof::python {
namespace {

std::string shape_text(const std::vector<py::ssize_t>& shape) {
  std::string text;
  for (const py::ssize_t size : shape) text += (text.empty() ? "" : ", ") + (size < 0 ? "n" : std::to_string(size));
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

bool is_rigid(const Eigen::Map<const RowMajor>& matrix) {
  constexpr double kRounding = 1e-6;
  const Eigen::Matrix3d rotation = matrix.topLeftCorner(3, 3);
  return (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kRounding &&
         rotation.determinant() > 0.0 && matrix.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
}

}  // namespace

void check_shape(const Array& array, std::initializer_list<py::ssize_t> shape, const char* name, bool finite) {
  const std::vector<py::ssize_t> given(array.shape(), array.shape() + array.ndim()), allowed(shape);
  bool fits = given.size() == allowed.size();
  for (std::size_t i = 0; fits && i < allowed.size(); ++i) fits = allowed[i] < 0 || allowed[i] == given[i];
  if (!fits)
    throw py::value_error(std::string(name) + ": has the shape " + shape_text(given) + "; allowed is " +
                          shape_text(allowed));
  for (py::ssize_t i = 0; finite && i < array.size(); ++i)
    if (!std::isfinite(array.data()[i]))
      throw py::value_error(std::string(name) + ": holds NaN or infinity; only finite numbers are allowed");
}

Vector6d vector6_of(const Array& array, const char* name) {
  check_shape(array, {6}, name);
  return matrix_of(array);
}

Eigen::MatrixXd covariance_of(const Array& array, py::ssize_t size, const char* name) {
  constexpr double kRounding = 1e-9;
  check_shape(array, {size, size}, name);
  const Eigen::MatrixXd matrix = matrix_of(array);
  const double asymmetry = (matrix - matrix.transpose()).cwiseAbs().maxCoeff();
  if (asymmetry > kRounding * matrix.cwiseAbs().maxCoeff() || matrix.diagonal().minCoeff() < 0.0)
    throw py::value_error(std::string(name) + ": is no covariance: must be symmetric, its diagonal not negative");
  return matrix;
}

Rigid3 pose_of(const py::handle& pose, const char* name) {
  if (py::isinstance<Rigid3>(pose)) return pose.cast<Rigid3>();
  const Array array = Array::ensure(pose);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(std::string(name) + ": must be a rigproof.Pose or a 4x4 matrix");
  }
  check_shape(array, {4, 4}, name);
  if (!is_rigid(matrix_of(array)))
    throw py::value_error(std::string(name) + ": is no rigid transform: a rotation and 0, 0, 0, 1 in the last row");
  return Rigid3::from_matrix(matrix_of(array));
}

std::vector<std::string> sentences_of(const std::vector<Finding>& findings) {
  std::vector<std::string> sentences;
  for (const Finding& finding : findings) sentences.push_back(words::sentence_of(finding));
  return sentences;
}

void add_errors(py::module_& module) {
  static py::exception<Error> error_type(module, "Error");
  error_type.doc() =
      "Bad input or environment, in the words of the command line: file, line, field, value and what is allowed.\n\n"
      "exit_code: what the command would exit with: 2 bad input, 75 try again.";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      py::object instance = py::handle(error_type)(words::message_of(error));
      instance.attr("exit_code") = static_cast<int>(error.exit_code());
      PyErr_SetObject(error_type.ptr(), instance.ptr());
    }
  });
}

}  // namespace rigproof::python

PYBIND11_MODULE(_core, module) {
  module.doc() = "Where is each camera on your robot, how sure are you, and prove it.";
  module.attr("__version__") = rigproof::version();
  rigproof::python::add_errors(module);
  rigproof::python::add_geometry(module);
  rigproof::python::add_inputs(module);
  rigproof::python::add_results(module);
  rigproof::python::add_validation(module);
  rigproof::python::add_work(module);
  rigproof::python::add_studies(module);
}
