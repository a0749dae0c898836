// What a calibration answers.
#include "answers.h"
#include "rigproof/words/sentences.h"

namespace rigproof::python {
namespace {

py::object covariance_or_none(const std::optional<Matrix6d>& covariance) {
  return covariance ? py::object(array_of(*covariance)) : py::none();
}

// Where a degree of freedom is not observable there is no figure.
py::object sigma_of(const EstimatedTransform& transform) {
  if (!transform.covariance) return py::none();
  Vector6d sigma = transform.covariance->diagonal().cwiseSqrt();
  for (std::size_t i = 0; i < 6; ++i)
    if (!transform.observable[i]) sigma(static_cast<Eigen::Index>(i)) = kNaN;
  return array_of(sigma);
}

py::dict budget_of(const EstimatedTransform& transform) {
  py::dict budget;
  for (const EstimatedTransform::Share& share : transform.budget)
    budget[share.source.c_str()] = array_of(Eigen::Map<const Vector6d>(share.share.data()));
  return budget;
}

void add_transform(py::module_& module) {
  py::class_<EstimatedTransform>(module, "EstimatedTransform", "The pose of `child` in `parent`.")
      .def_readonly("parent", &EstimatedTransform::parent)
      .def_readonly("child", &EstimatedTransform::child)
      .def_property_readonly("T_parent_child", copy_of(&EstimatedTransform::T_parent_child))
      .def_property_readonly(
          "covariance", [](const EstimatedTransform& t) { return covariance_or_none(t.covariance); },
          "(6, 6) in the chart of transform_error(), m and rad; None if the method has none")
      .def_property_readonly("sigma", sigma_of, "(6,): tx ty tz [m], rx ry rz [rad]; NaN where not observable")
      .def_property_readonly(
          "observable", [](const EstimatedTransform& t) { return array_of(t.observable); },
          "(6,) bool: what the data determine")
      .def_property_readonly("budget", budget_of, "Share (6,) of each variance by its source: corners, odometry, ..")
      .def("__repr__", [](const EstimatedTransform& t) { return "<EstimatedTransform: " + sentence_of(t) + ">"; });
}

py::object poses_of(const Result& result) {
  std::map<std::string, Rigid3> poses;
  for (const EstimatedTransform& transform : result.camera_to_robot)
    if (transform.fully_observable()) poses[transform.child] = transform.T_parent_child;
  return py::cast(poses);
}

py::dict use_of(const Result& result) {
  py::dict all;
  for (const CameraUse& use : result.use)
    all[use.camera.c_str()] =
        py::dict("used"_a = use.used, "left_out"_a = use.left_out, "reprojection_rms_px"_a = use.reprojection_rms_px);
  return all;
}

py::list residuals_of(const Result& result) {
  return list_of(result.residuals, [](const ResidualSummary& summary) {
    return py::dict("name"_a = summary.name, "unit"_a = summary.unit, "count"_a = summary.count, "rms"_a = summary.rms);
  });
}

py::list estimated_of(const Result& result) {
  return list_of(result.also_estimated, [](const EstimatedQuantity& quantity) {
    return py::dict("camera"_a = quantity.camera, "name"_a = quantity.name, "value"_a = quantity.value,
                    "sigma"_a = quantity.sigma, "prior_sigma"_a = quantity.prior_sigma);
  });
}

py::list boards_of(const Result& result) {
  return list_of(result.boards, [](const EstimatedBoard& board) {
    return py::dict("number"_a = board.number, "T_first_board"_a = board.T_first_board, "sigma"_a = board.sigma);
  });
}

std::map<std::string, Camera> lenses_of(const Result& result) {
  std::map<std::string, Camera> lenses;
  for (const EstimatedLens& lens : result.lenses) lenses[lens.camera] = lens.intrinsics;
  return lenses;
}

Result refused(const std::string& method, const std::string& reason) {
  Result result;
  result.method = method;
  result.reasons.push_back(stated(reason, Severity::kRefusal));
  return result;
}

}  // namespace

Result result_of_poses(const std::string& method, const py::dict& poses, const std::string& robot_frame,
                       const py::dict& covariances) {
  Result result;
  result.method = method;
  result.status = ResultStatus::kSolved;
  for (const auto& [name, pose] : poses) {
    if (!py::isinstance<py::str>(name)) throw py::type_error("poses: its keys must be names of cameras");
    EstimatedTransform& transform = result.camera_to_robot.emplace_back();
    transform.parent = robot_frame;
    transform.child = name.cast<std::string>();
    transform.T_parent_child = pose_of(pose, ("poses: " + transform.child).c_str());
    if (covariances.contains(name)) {
      const std::string place = "covariances: " + transform.child;
      const Array array = Array::ensure(covariances[name]);
      if (!array) throw py::type_error(place + ": must be numbers (6, 6)");
      transform.covariance = covariance_of(array, 6, place.c_str());
    }
  }
  for (const auto& [name, unused] : covariances)
    if (!poses.contains(name))
      throw py::value_error("covariances: " + py::str(name).cast<std::string>() + ": has no pose");
  if (result.camera_to_robot.empty())
    throw py::value_error("poses: holds none; Result.refused() says why there is none");
  return result;
}

void add_results(py::module_& module) {
  add_transform(module);
  py::class_<Result>(module, "Result", "What a method answers, as in results/METHOD.yaml.")
      .def(py::init(&result_of_poses), py::arg("method"), py::arg("poses"), py::arg("robot_frame") = "base_footprint",
           py::arg("covariances") = py::dict(),
           "Of your own: T_robot_camera (Pose or (4, 4)) by the name of the camera, and covariances (6, 6) in the "
           "chart\n"
           "of transform_error() of those that have one.")
      .def_static("refused", refused, py::arg("method"), py::arg("reason"), "That nothing can be answered, and why.")
      .def_static("load", load_result, py::arg("file"), py::call_guard<py::gil_scoped_release>(),
                  "Ours or the smallest one that somebody else wrote. Throws Error with every problem found.")
      .def(
          "save",
          [](const Result& result, const std::filesystem::path& file) {
            save_result(result, file, words::sentence_of);
          },
          py::arg("file"), py::call_guard<py::gil_scoped_release>(), "The bytes that the command line would write.")
      .def_readonly("method", &Result::method)
      .def_property_readonly(
          "status", [](const Result& result) { return result_status_name(result.status); },
          "solved, partial or refused")
      .def_property_readonly("reasons", copy_of(&Result::reasons), "Why it is not solved, the likely cause first")
      .def_property_readonly("notes", copy_of(&Result::notes))
      .def_property_readonly("poses", poses_of, "T_robot_camera of each camera whose pose is known in all six degrees")
      .def_property_readonly("camera_to_robot", copy_of(&Result::camera_to_robot))
      .def_property_readonly("camera_to_camera", copy_of(&Result::camera_to_camera))
      .def_property_readonly(
          "joint_covariance",
          [](const Result& result) {
            return result.joint_covariance ? py::object(array_of(*result.joint_covariance)) : py::none();
          },
          "(6n, 6n) of all of camera_to_robot; None if the method has none")
      .def_property_readonly("use", use_of, "By camera: used, left_out, reprojection_rms_px")
      .def_property_readonly("residuals", residuals_of, "Groups: name, unit, count, rms")
      .def_property_readonly("also_estimated", estimated_of, "camera, name (with unit), value, sigma, prior_sigma")
      .def_property_readonly("lenses", lenses_of, "Intrinsics by camera, where the method estimated them")
      .def_property_readonly(
          "boards", boards_of,
          "Of more_boards: number (2 is the first of them), T_first_board, sigma (tx ty tz along the "
          "first board's axes, rx ry rz about its own)")
      .def_property_readonly(
          "rotation_centre_m", [](const Result& result) { return array_of(result.rotation_centre_m); },
          "(2,): where in the robot's frame the rig stated that it turns")
      .def_readonly("rotation_centre_sigma_m", &Result::rotation_centre_sigma_m,
                    "One sigma of that; None if not stated")
      .def_readonly("solve_s", &Result::solve_s, "0 of one that was read")
      .def("__repr__", [](const Result& result) {
        return "<Result of " + result.method + ": " + result_status_name(result.status) + ">";
      });
}

}  // namespace rigproof::python
