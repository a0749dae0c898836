// What is calibrated from: recordings, observations; and the truth of a run.
#include "bindings.h"
#include "rigproof/core/observations_text.h"
#include "rigproof/core/recording.h"
#include "rigproof/core/text.h"
#include "rigproof/truth/truth.h"
#include "rigproof/words/sentences.h"

namespace rigproof::python {
namespace {

Eigen::RowVector3d odometry_of(const Stop& stop) { return {stop.x_m, stop.y_m, stop.yaw_rad}; }

void add_findings(py::module_& module) {
  py::class_<Finding>(module, "Finding", "What was found in data or in a solution; str() says it in words.")
      .def_readonly("code", &Finding::code, "Stable: docs/reference/findings.md lists all.")
      .def_property_readonly("severity", [](const Finding& finding) { return severity_name(finding.severity); })
      .def_property_readonly("cameras", copy_of(&Finding::cameras))
      .def_property_readonly("axes", copy_of(&Finding::axes), "Of x y z roll pitch yaw tilt_x tilt_y, in the robot")
      .def_property_readonly("stops", copy_of(&Finding::stops))
      .def_property_readonly(
          "values",
          [](const Finding& finding) {
            py::dict values;
            for (const FindingValue& value : finding.values) values[value.name.c_str()] = py::cast(value.value);
            return values;
          },
          "Figures by name, whose unit is in the name")
      .def_property_readonly("because", copy_of(&Finding::because))
      .def("__str__", [](const Finding& finding) { return words::sentence_of(finding); })
      .def("__repr__", [](const Finding& finding) {
        return "<Finding " + finding.code + ": " + words::sentence_of(finding) + ">";
      });
  py::class_<Exclusion>(module, "Exclusion", "A frame, or its depth, that is not used, and why.")
      .def_readonly("camera", &Exclusion::camera, "Index of the camera")
      .def_readonly("stop", &Exclusion::stop, "-1: belongs to no stop")
      .def_readonly("file", &Exclusion::file)
      .def_readonly("depth", &Exclusion::depth, "Only the depth is left out, its image is not.")
      .def_property_readonly("why", copy_of(&Exclusion::why));
}

void add_rig(py::module_& module) {
  py::class_<RigCamera>(module, "RigCamera", "One camera as the rig describes it.")
      .def_readonly("name", &RigCamera::name)
      .def_readonly("sensor", &RigCamera::sensor)
      .def_readonly("link", &RigCamera::link)
      .def_readonly("folder", &RigCamera::folder)
      .def_property_readonly("camera", copy_of(&RigCamera::camera), "The stated intrinsics")
      .def_property_readonly("has_depth", [](const RigCamera& camera) { return camera.depth.has_value(); })
      .def("__repr__", [](const RigCamera& camera) { return "<RigCamera " + camera.name + ">"; });
  py::class_<CameraFrame>(module, "CameraFrame", "One image; files are relative to the recording's folder.")
      .def_readonly("color_file", &CameraFrame::color_file)
      .def_readonly("depth_file", &CameraFrame::depth_file, "Empty if there is none")
      .def_readonly("cloud_file", &CameraFrame::cloud_file, "Empty if there is none")
      .def_readonly("stamp_s", &CameraFrame::stamp_s, "Middle of the exposure")
      .def_readonly("exposure_s", &CameraFrame::exposure_s, "0: unknown");
}

std::map<std::string, std::vector<CameraFrame>> frames_of(const Recording& recording) {
  std::map<std::string, std::vector<CameraFrame>> frames;
  for (std::size_t i = 0; i < recording.rig.cameras.size(); ++i)
    frames[recording.rig.cameras[i].name] = recording.frames[i];
  return frames;
}

void add_recording(py::module_& module) {
  py::class_<Recording>(module, "Recording", "What a robot could record; never holds the truth. Images are not opened.")
      .def_static("load", load_recording, py::arg("folder"), py::call_guard<py::gil_scoped_release>(),
                  "Throws Error with every problem found.")
      .def_property_readonly("folder", copy_of(&Recording::folder))
      .def_property_readonly("robot_frame", [](const Recording& r) { return r.rig.robot_frame; })
      .def_property_readonly("board", [](const Recording& r) { return r.rig.board; })
      .def_property_readonly("more_boards", [](const Recording& r) { return r.rig.more_boards; })
      .def_property_readonly("cameras", [](const Recording& r) { return r.rig.cameras; })
      .def_property_readonly("frames", frames_of, "Images of each camera, by its name, in the order of time")
      .def_property_readonly(
          "odometry",
          [](const Recording& r) {
            return rows_of(r.odometry, 4, [](const OdometrySample& sample) {
              return Eigen::RowVector4d(sample.stamp_s, sample.x_m, sample.y_m, sample.yaw_rad);
            });
          },
          "(n, 4): stamp_s, x_m, y_m, yaw_rad in odom, of the point about which the robot turns")
      .def("__repr__", [](const Recording& r) { return "<Recording " + r.folder.string() + ">"; });
}

BoardView board_view_of(int stop, int camera, double stamp_s, const std::vector<int>& ids, const Array& pixels,
                        const std::optional<Array>& covariances, std::string file, int board) {
  const auto count = static_cast<py::ssize_t>(ids.size());
  check_shape(pixels, {count, 2}, "pixels");
  if (covariances) check_shape(*covariances, {count, 2, 2}, "covariances_px2");
  BoardView view;
  view.stop = stop;
  view.camera = camera;
  view.stamp_s = stamp_s;
  view.file = std::move(file);
  view.board = board;
  for (py::ssize_t i = 0; i < count; ++i) {
    CornerObservation& corner = view.corners.emplace_back();
    corner.id = ids[static_cast<std::size_t>(i)];
    corner.pixel = matrix_of(pixels).row(i).transpose();
    if (covariances) corner.covariance_px2 = Eigen::Map<const Eigen::Matrix2d>(covariances->data() + 4 * i);
  }
  return view;
}

py::array_t<int> ids_of(const BoardView& view) {
  py::array_t<int> ids(static_cast<py::ssize_t>(view.corners.size()));
  int* to = ids.mutable_data();
  for (const CornerObservation& corner : view.corners) *to++ = corner.id;
  return ids;
}

py::array_t<double> covariances_of(const BoardView& view) {
  py::array_t<double> array({static_cast<py::ssize_t>(view.corners.size()), py::ssize_t{2}, py::ssize_t{2}});
  double* to = array.mutable_data();
  for (const CornerObservation& corner : view.corners) {
    Eigen::Map<Eigen::Matrix2d>{to} = corner.covariance_px2;
    to += 4;
  }
  return array;
}

void add_views(py::module_& module) {
  py::class_<BoardView>(module, "BoardView", "The board as one camera sees it from one stop. Immutable.")
      .def(py::init(&board_view_of), py::arg("stop"), py::arg("camera"), py::arg("stamp_s"), py::arg("ids"),
           py::arg("pixels"), py::arg("covariances_px2") = py::none(), py::arg("file") = "", py::arg("board") = 0,
           "Of corners that your own detector found; without covariances one pixel each.")
      .def_readonly("stop", &BoardView::stop, "Index of the stop")
      .def_readonly("camera", &BoardView::camera, "Index of the camera")
      .def_readonly("stamp_s", &BoardView::stamp_s)
      .def_readonly("file", &BoardView::file)
      .def_readonly("board", &BoardView::board, "Which of the boards: 0 is `board`, then `more_boards`")
      .def_property_readonly("ids", ids_of, "(n,): the board's corner of each")
      .def_property_readonly(
          "pixels",
          [](const BoardView& view) {
            return rows_of(view.corners, 2, [](const CornerObservation& corner) { return corner.pixel.transpose(); });
          },
          "(n, 2), in the distorted image")
      .def_property_readonly("covariances_px2", covariances_of, "(n, 2, 2), of the detector's fit");
  py::class_<PlaneObservation>(module, "PlaneObservation",
                               "A plane in a depth image, {p : a . p = 1} in the colour camera's frame.")
      .def_readonly("stop", &PlaneObservation::stop, "Index of the stop")
      .def_readonly("camera", &PlaneObservation::camera, "Index of the camera")
      .def_readonly("file", &PlaneObservation::file)
      .def_readonly("effective_points", &PlaneObservation::effective_points)
      .def_readonly("residual_rms_sigma", &PlaneObservation::residual_rms)
      .def_property_readonly(
          "inverse_depth_plane_per_m", [](const PlaneObservation& p) { return array_of(p.inverse_depth_plane); },
          "a (3,) [1/m]; of the ground at height h with unit normal n towards the camera: -n / h")
      .def_property_readonly(
          "covariance_per_m2", [](const PlaneObservation& p) { return array_of(p.covariance_per_m2); }, "(3, 3), of a");
}

Observations parse(const std::string& text) { return parse_observations(text, "observations"); }

// What a file of these would be refused for is refused here, too.
void set_views(Observations& observations, std::vector<BoardView> views) {
  Observations changed = observations;
  changed.board_views = std::move(views);
  observations = parse(observations_text(changed));
}

py::array_t<double> stamps_of(const Observations& o) {
  Eigen::VectorXd stamps(static_cast<Eigen::Index>(o.stops.size()));
  for (std::size_t i = 0; i < o.stops.size(); ++i) stamps(static_cast<Eigen::Index>(i)) = o.stops[i].stamp_s;
  return array_of(stamps);
}

void add_observations(py::module_& module) {
  py::class_<Observations>(module, "Observations",
                           "What calibration sees: corners, planes and odometry at each stop of the robot.")
      .def_static("load", load_observations, py::arg("file"), py::call_guard<py::gil_scoped_release>(),
                  "Throws Error with every problem found.")
      .def_static("from_json", parse, py::arg("text"), py::call_guard<py::gil_scoped_release>(),
                  "Of what observations.json has. Throws Error with every problem found.")
      .def("to_json", observations_text, py::call_guard<py::gil_scoped_release>())
      .def("save", save_observations, py::arg("file"), py::call_guard<py::gil_scoped_release>())
      .def_readonly("source", &Observations::source)
      .def_readonly("robot_frame", &Observations::robot_frame)
      .def_property_readonly("board", copy_of(&Observations::board))
      .def_property_readonly("more_boards", copy_of(&Observations::more_boards))
      .def_property_readonly("cameras", copy_of(&Observations::cameras))
      .def_property_readonly("stamps_s", stamps_of, "(stops,)")
      .def_property_readonly(
          "odometry", [](const Observations& o) { return rows_of(o.stops, 3, odometry_of); },
          "(stops, 3): x_m, y_m, yaw_rad of the robot's origin in odom at each stop")
      .def_property_readonly(
          "velocities",
          [](const Observations& o) {
            return rows_of(o.stops, 3, [](const Stop& stop) { return stop.velocity.transpose(); });
          },
          "(stops, 3): m/s, m/s, rad/s in the robot's frame; zero where it stands")
      .def_property_readonly(
          "accelerations",
          [](const Observations& o) {
            return rows_of(o.stops, 3, [](const Stop& stop) { return stop.acceleration.transpose(); });
          },
          "(stops, 3): m/s^2, m/s^2, rad/s^2, how that changes; zero where too few rows of odometry tell")
      .def_property("board_views", copy_of(&Observations::board_views), set_views,
                    "Sorted by stop, then camera. Assigning a list replaces and checks them all.")
      .def_property_readonly("ground_planes", copy_of(&Observations::ground_planes))
      .def_property_readonly("board_planes", copy_of(&Observations::board_planes))
      .def_property_readonly("exclusions", copy_of(&Observations::exclusions))
      .def("__repr__",
           [](const Observations& o) {
             return "<Observations of " + o.source + ": " + std::to_string(o.cameras.size()) + " cameras x " +
                    std::to_string(o.stops.size()) + " stops, " + std::to_string(o.board_views.size()) +
                    " board views>";
           })
      .def(py::pickle(&observations_text, &parse));
}

std::map<std::string, Rigid3> true_poses(const Truth& truth) {
  std::map<std::string, Rigid3> poses;
  for (const TrueCamera& camera : truth.cameras) poses[camera.name] = camera.T_robot_camera;
  return poses;
}

py::list true_boards(const Truth& truth) {
  return list_of(truth.more_boards, [](const TrueBoard& board) {
    return py::dict("board"_a = board.board, "T_world_board"_a = board.T_world_board);
  });
}

std::vector<Rigid3> robot_poses(const Truth& truth) {
  std::vector<Rigid3> poses;
  for (const TrueStop& stop : truth.stops) poses.push_back(stop.T_world_robot);
  return poses;
}

void add_truth(py::module_& module) {
  py::class_<TrueCamera>(module, "TrueCamera", "A camera as it truly is.")
      .def_readonly("name", &TrueCamera::name)
      .def_property_readonly("T_robot_camera", copy_of(&TrueCamera::T_robot_camera))
      .def_property_readonly("camera", copy_of(&TrueCamera::camera), "The true intrinsics")
      .def_readonly("depth_scale", &TrueCamera::depth_scale, "measured = scale * true; None without depth")
      .def_property_readonly("sensing", copy_of(&TrueCamera::sensing), "What is simulated of the sensor, by name");
  py::class_<Truth>(module, "Truth", "What only a simulator knows.")
      .def_static("load", load_truth, py::arg("file"), py::call_guard<py::gil_scoped_release>(),
                  "truth/truth.yaml. Throws Error with every problem found.")
      .def("save", save_truth, py::arg("file"), py::call_guard<py::gil_scoped_release>())
      .def_readonly("scene", &Truth::scene)
      .def_readonly("seed", &Truth::seed)
      .def_property_readonly("board", [](const Truth& truth) { return truth.board; })
      .def_property_readonly("cameras", copy_of(&Truth::cameras))
      .def_property_readonly("poses", true_poses, "T_robot_camera of each camera, by its name")
      .def_property_readonly("T_world_board", [](const Truth& truth) { return truth.T_world_board; })
      .def_property_readonly("more_boards", true_boards, "Boards that stand elsewhere: board, T_world_board")
      .def_property_readonly("T_world_robot", robot_poses, "At each stop")
      .def_property_readonly(
          "stamps_s",
          [](const Truth& truth) {
            Eigen::VectorXd stamps(static_cast<Eigen::Index>(truth.stops.size()));
            for (std::size_t i = 0; i < truth.stops.size(); ++i)
              stamps(static_cast<Eigen::Index>(i)) = truth.stops[i].stamp_s;
            return array_of(stamps);
          },
          "(stops,)")
      .def_property_readonly("drawn", copy_of(&Truth::drawn), "What was drawn once for the run, by its field")
      .def("__repr__", [](const Truth& truth) {
        return "<Truth of " + truth.scene + ", seed " + std::to_string(truth.seed) + ", " +
               std::to_string(truth.stops.size()) + " stops>";
      });
}

}  // namespace

void add_inputs(py::module_& module) {
  add_findings(module);
  add_rig(module);
  add_recording(module);
  add_views(module);
  add_observations(module);
  add_truth(module);
}

}  // namespace rigproof::python
