// Poses, cameras, boards.
#include "bindings.h"
#include "rigproof/core/board.h"
#include "rigproof/core/camera.h"
#include "rigproof/core/text.h"
#include "rigproof/validate/statistics.h"

namespace rigproof::python {
namespace {

Rigid3 pose_of_quaternion(const Array& translation_m, const Array& quaternion_xyzw) {
  check_shape(translation_m, {3}, "translation_m");
  check_shape(quaternion_xyzw, {4}, "quaternion_xyzw");
  const double* const q = quaternion_xyzw.data();
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  constexpr double kMostOff = 0.01;  // as in a result's file
  if (std::abs(rotation.norm() - 1.0) > kMostOff)
    throw py::value_error("quaternion_xyzw: has the length " + number_text(rotation.norm()) + "; it must be 1");
  return {rotation, matrix_of(translation_m)};
}

// A pose, points (n, 3), or one point (3,).
py::object times(const Rigid3& T, const py::object& other) {
  if (py::isinstance<Rigid3>(other)) return py::cast(T * other.cast<Rigid3>());
  const Array points = Array::ensure(other);
  if (!points) {
    PyErr_Clear();
    throw py::type_error("a Pose is multiplied by a Pose or by points of the shape (n, 3) or (3,)");
  }
  if (points.ndim() == 1) {
    check_shape(points, {3}, "point", false);
    return array_of(T * Eigen::Vector3d(matrix_of(points)));
  }
  check_shape(points, {-1, 3}, "points", false);
  RowMajor moved = matrix_of(points);
  for (Eigen::Index i = 0; i < moved.rows(); ++i)
    moved.row(i) = (T * Eigen::Vector3d(moved.row(i).transpose())).transpose();
  return array_of(moved);
}

Eigen::Vector4d xyzw_of(const Rigid3& T) { return T.rotation.coeffs(); }

void add_pose(py::module_& module) {
  py::class_<Rigid3>(module, "Pose",
                     "A rigid transform T_target_source, immutable: p_target = T_target_source @ p_source.\n"
                     "Metres; `Pose(matrix)` takes a 4x4 matrix, `Pose()` is the identity.")
      .def(py::init<>())
      .def(py::init([](const py::object& matrix) { return pose_of(matrix, "matrix"); }), py::arg("matrix"))
      .def_static("from_quaternion", pose_of_quaternion, py::arg("translation_m"), py::arg("quaternion_xyzw"),
                  "Of a translation (3,) and a quaternion x y z w of unit length.")
      .def_static(
          "exp", [](const Array& xi) { return se3_exp(vector6_of(xi, "xi")); }, py::arg("xi"),
          "The screw motion xi = (rho, phi) (6,), metres and radians.")
      .def(
          "log", [](const Rigid3& T) { return array_of(se3_log(T)); }, "(rho, phi) (6,): the inverse of exp().")
      .def_property_readonly(
          "matrix", [](const Rigid3& T) { return array_of(T.matrix()); }, "(4, 4)")
      .def_property_readonly(
          "rotation", [](const Rigid3& T) { return array_of(T.rotation_matrix()); }, "(3, 3)")
      .def_property_readonly(
          "translation_m", [](const Rigid3& T) { return array_of(T.translation); }, "(3,)")
      .def_property_readonly(
          "quaternion_xyzw", [](const Rigid3& T) { return array_of(xyzw_of(T)); }, "(4,), of unit length")
      .def("inverse", &Rigid3::inverse)
      .def("__matmul__", times, py::arg("other"),
           "T_a_b @ T_b_c is T_a_c; T_a_b @ points maps (n, 3) or (3,) from b to a.")
      .def("__eq__",
           [](const Rigid3& T, const py::object& other) {
             if (!py::isinstance<Rigid3>(other)) return false;
             const auto U = other.cast<Rigid3>();
             return T.translation == U.translation && xyzw_of(T) == xyzw_of(U);
           })
      .def("__repr__",
           [](const Rigid3& T) {
             return "Pose(translation_m=" + py::repr(array_of(T.translation)).cast<std::string>() +
                    ", quaternion_xyzw=" + py::repr(array_of(xyzw_of(T))).cast<std::string>() + ")";
           })
      .def(py::pickle([](const Rigid3& T) { return py::make_tuple(array_of(T.translation), array_of(xyzw_of(T))); },
                      [](const py::tuple& state) {
                        Rigid3 T;  // not normalised again: the same bits
                        T.translation = matrix_of(state[0].cast<Array>());
                        T.rotation.coeffs() = Eigen::Vector4d(matrix_of(state[1].cast<Array>()));
                        return T;
                      }));
  py::implicitly_convertible<py::array, Rigid3>();
}

Lens lens_of(const std::string& name) {
  for (const Lens lens : {Lens::kPinhole, Lens::kBrownConrady, Lens::kKannalaBrandt})
    if (name == lens_name(lens)) return lens;
  throw py::value_error("lens: \"" + name + "\"; allowed are pinhole, brown_conrady, kannala_brandt");
}

Camera camera_of(int width_px, int height_px, double fx_px, double fy_px, double cx_px, double cy_px,
                 const std::string& lens, const std::vector<double>& distortion) {
  Camera camera;
  camera.lens = lens_of(lens);
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fx_px = fx_px;
  camera.fy_px = fy_px;
  camera.cx_px = cx_px;
  camera.cy_px = cy_px;
  const auto count = static_cast<std::size_t>(coefficient_count(camera.lens));
  if (distortion.size() != count)
    throw py::value_error("distortion: " + std::to_string(distortion.size()) + " numbers; " + lens + " has " +
                          std::to_string(count));
  std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
  const Eigen::Map<const Eigen::Matrix<double, 5, 1>> coefficients(camera.distortion.data());
  if (width_px < 1 || height_px < 1 || !(fx_px > 0.0) || !(fy_px > 0.0) ||
      !Eigen::Vector4d(fx_px, fy_px, cx_px, cy_px).allFinite() || !coefficients.allFinite())
    throw py::value_error("a camera's size and focal lengths must be positive, and all numbers finite");
  return camera;
}

// Where a point or pixel has no image or ray, the row is NaN.
py::object project(const Camera& camera, const Array& points, bool jacobians) {
  check_shape(points, {-1, 3}, "points_camera_m", false);
  const auto count = points.shape(0);
  py::array_t<double> pixels({count, py::ssize_t{2}}),
      J_pixel_point({jacobians ? count : 0, py::ssize_t{2}, py::ssize_t{3}});
  const auto from = matrix_of(points);
  Eigen::Map<RowMajor> to(pixels.mutable_data(), count, 2);
  Eigen::Map<RowMajor> rows_of_J(J_pixel_point.mutable_data(), jacobians ? 2 * count : 0, 3);
  {
    const py::gil_scoped_release released;
    for (Eigen::Index i = 0; i < count; ++i) {
      Eigen::Vector2d pixel = Eigen::Vector2d::Constant(kNaN);
      Eigen::Matrix<double, 2, 3> J = Eigen::Matrix<double, 2, 3>::Constant(kNaN);
      camera.project(from.row(i).transpose(), &pixel, jacobians ? &J : nullptr);
      to.row(i) = pixel.transpose();
      if (jacobians) rows_of_J.middleRows<2>(2 * i) = J;
    }
  }
  if (!jacobians) return std::move(pixels);
  return py::make_tuple(pixels, J_pixel_point);
}

py::array_t<double> unproject(const Camera& camera, const Array& pixels) {
  check_shape(pixels, {-1, 2}, "pixels", false);
  const auto from = matrix_of(pixels);
  RowMajor rays(from.rows(), 3);
  {
    const py::gil_scoped_release released;
    for (Eigen::Index i = 0; i < from.rows(); ++i) {
      Eigen::Vector3d ray = Eigen::Vector3d::Constant(kNaN);
      if (from.row(i).allFinite()) camera.unproject(from.row(i).transpose(), &ray);
      rays.row(i) = ray.transpose();
    }
  }
  return array_of(rays);
}

std::vector<double> coefficients_of(const Camera& camera) {
  return {camera.distortion.begin(), camera.distortion.begin() + coefficient_count(camera.lens)};
}

void add_camera(py::module_& module) {
  py::class_<Camera>(module, "Camera",
                     "Intrinsics, immutable. The centre of the top-left pixel is (0, 0). lens: pinhole, brown_conrady "
                     "(k1 k2 p1 p2 k3) or kannala_brandt (k1 k2 k3 k4), as OpenCV has them.")
      .def(py::init(&camera_of), py::arg("width_px"), py::arg("height_px"), py::arg("fx_px"), py::arg("fy_px"),
           py::arg("cx_px"), py::arg("cy_px"), py::arg("lens") = "pinhole",
           py::arg("distortion") = std::vector<double>())
      .def_readonly("width_px", &Camera::width_px)
      .def_readonly("height_px", &Camera::height_px)
      .def_readonly("fx_px", &Camera::fx_px)
      .def_readonly("fy_px", &Camera::fy_px)
      .def_readonly("cx_px", &Camera::cx_px)
      .def_readonly("cy_px", &Camera::cy_px)
      .def_property_readonly("lens", [](const Camera& camera) { return lens_name(camera.lens); })
      .def_property_readonly("distortion", coefficients_of)
      .def_property_readonly(
          "matrix", [](const Camera& camera) { return array_of(camera.matrix()); }, "K (3, 3)")
      .def(
          "project", project, py::arg("points_camera_m"), py::arg("jacobians") = false,
          "Pixels (n, 2) of points (n, 3) in the camera's optical frame, with `jacobians` also their derivatives\n"
          "(n, 2, 3) by the points. Rows of points that are behind the camera, or beyond the field of the lens model,\n"
          "are NaN. Pixels may lie outside of the image.")
      .def("unproject", unproject, py::arg("pixels"),
           "Rays (n, 3) through pixels (n, 2), with z = 1; NaN where the lens has none.")
      .def("__repr__",
           [](const Camera& camera) {
             return "Camera(" + std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px) +
                    ", fx_px=" + number_text(camera.fx_px) + ", " + lens_name(camera.lens) + ")";
           })
      .def(py::pickle(
          [](const Camera& c) {
            return py::make_tuple(c.width_px, c.height_px, c.fx_px, c.fy_px, c.cx_px, c.cy_px, lens_name(c.lens),
                                  coefficients_of(c));
          },
          [](const py::tuple& t) {
            return camera_of(t[0].cast<int>(), t[1].cast<int>(), t[2].cast<double>(), t[3].cast<double>(),
                             t[4].cast<double>(), t[5].cast<double>(), t[6].cast<std::string>(),
                             t[7].cast<std::vector<double>>());
          }));
}

py::object place_of(const Board& board) {
  if (!board.place) return py::none();
  py::dict place;
  place["T_first_board"] = board.place->T_first_board;
  place["sigma_m"] = board.place->sigma_m;
  place["sigma_rad"] = board.place->sigma_rad;
  return place;
}

void add_board(py::module_& module) {
  py::class_<Board>(module, "Board",
                    "The board, immutable. Its frame: origin at the first inner corner, x and y along the inner\n"
                    "corners, z into the board.")
      .def_readonly("type", &Board::type)
      .def_readonly("squares_x", &Board::squares_x)
      .def_readonly("squares_y", &Board::squares_y)
      .def_readonly("square_m", &Board::square_m)
      .def_property_readonly(
          "corners_m",
          [](const Board& board) { return rows_of(board.corners(), 3, [](const auto& p) { return p.transpose(); }); },
          "Inner corners (n, 3) in the board frame, by id.")
      .def_property_readonly("place", place_of,
                             "Of one of more_boards, where it was measured: T_first_board, sigma_m, sigma_rad; None: "
                             "it may stand anywhere")
      .def("__repr__", [](const Board& board) {
        return "Board(" + board.type + ", " + std::to_string(board.squares_x) + "x" + std::to_string(board.squares_y) +
               " squares of " + number_text(board.square_m) + " m)";
      });
}

std::optional<double> nees(const std::vector<Rigid3>& estimates, const std::vector<Rigid3>& truths,
                           const Array& covariance) {
  if (estimates.size() != truths.size())
    throw py::value_error("estimates, truths: " + std::to_string(estimates.size()) + " and " +
                          std::to_string(truths.size()) + " poses; there must be as many of both");
  return normalised_error_squared(
      estimates, truths, covariance_of(covariance, 6 * static_cast<py::ssize_t>(estimates.size()), "covariance"));
}

}  // namespace

void add_geometry(py::module_& module) {
  add_pose(module);
  add_camera(module);
  add_board(module);
  module.def(
      "transform_error",
      [](const Rigid3& estimate, const Rigid3& truth) { return array_of(transform_error(estimate, truth)); },
      py::arg("T_estimate"), py::arg("T_true"),
      "(6,): t_est - t_true [m] and the rotation vector of R_est R_true^T [rad], along the parent's axes: the chart "
      "of\n"
      "every error, sigma and covariance here (tx ty tz rx ry rz).");
  module.def(
      "apply_transform_error",
      [](const Rigid3& T, const Array& error) { return apply_transform_error(T, vector6_of(error, "error")); },
      py::arg("T"), py::arg("error"), "The pose whose transform_error() against T is `error` (6,).");
  module.def("nees", nees, py::arg("estimates"), py::arg("truths"), py::arg("covariance"),
             "Normalised estimation error squared of n poses with their joint covariance (6n, 6n); honest sigmas make\n"
             "it chi-square with 6n degrees of freedom. None if the covariance is not positive definite.");
}

}  // namespace rigproof::python
