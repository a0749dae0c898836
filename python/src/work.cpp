// What takes long: reading, looking at images, solving.
#include <string>
#include <variant>

#include "bindings.h"
#include "python_method.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/calib/methods/registry.h"
#include "rigproof/core/data_path.h"
#include "rigproof/geometric/geometric.h"
#include "rigproof/study/workflow/external.h"
#include "rigproof/study/workflow/workflow.h"
#include "watch.h"

namespace rigproof::python {
namespace {

using Data = std::variant<Observations, Input, std::filesystem::path>;

std::optional<Observations> observations_beside(const Input& input) {
  if (input.observations) return input.observations;
  const std::filesystem::path file = product_folder(input) / "observations.json";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  return load_observations(file);
}

std::map<std::string, Result> results_beside(const Input& input) {
  std::map<std::string, Result> results;
  for (const auto& file : result_files(product_folder(input) / "results"))
    results[file.stem().string()] = load_result(file);
  return results;
}

void add_input(py::module_& module) {
  const auto released = py::call_guard<py::gil_scoped_release>();
  py::class_<Input>(module, "Input", "A run, a recording, a foreign layout, or observations: what open() found.")
      .def_property_readonly("path", copy_of(&Input::path))
      .def_property_readonly("format", [](const Input& input) { return input.format ? input.format->name : ""; })
      .def_property_readonly("recording", copy_of(&Input::recording), "None where there are observations alone")
      .def_property_readonly("observations", py::cpp_function(observations_beside, released),
                             "observations.json, as `rigproof observe` or observe() left it; None if it is not there")
      .def_property_readonly("truth", py::cpp_function(truth_beside, released), "None for what was not generated")
      .def_property_readonly("results", py::cpp_function(results_beside, released), "results/*.yaml by method")
      .def("__repr__", [](const Input& input) { return "<Input " + input.path.string() + ">"; });
}

Observations observe_data(const Data& data, int threads, const py::object& progress) {
  if (const auto* observations = std::get_if<Observations>(&data)) return *observations;
  return watched(progress, [&](Watch& watch) {
    const auto* path = std::get_if<std::filesystem::path>(&data);
    const Input input = path != nullptr ? open_input(*path) : std::get<Input>(data);
    ObserveOptions options;
    options.threads = threads;
    options.progress = [&watch](std::size_t done, std::size_t all) { return watch.tell(done, all); };
    return observations_of(input, options);
  });
}

std::shared_ptr<const Method> method_of(const py::object& method) {
  if (!py::isinstance<py::str>(method)) return std::make_shared<PythonMethod>(method);
  return methods_by_name({method.cast<std::string>()}).front();
}

Result calibrate(const Data& data, const py::object& method, int threads, const py::object& progress) {
  const std::shared_ptr<const Method> chosen = method_of(method);
  std::optional<Recording> recording;
  Data opened = data;
  if (const auto* path = std::get_if<std::filesystem::path>(&data)) {
    const py::gil_scoped_release released;
    opened = open_input(*path);
  }
  if (const auto* input = std::get_if<Input>(&opened)) recording = input->recording;
  const Observations observations = observe_data(opened, threads, progress);
  if (const auto* ours = dynamic_cast<const PythonMethod*>(chosen.get()))
    return refusal_of(*ours, {observations}) ? run_method(*ours, {observations}) : ours->call(observations);
  return watched(progress, [&](Watch& watch) {
    MethodInput input{observations, recording ? &*recording : nullptr, threads};
    input.progress = [&watch](std::size_t done, std::size_t all) { return watch.tell(done, all); };
    input.keep_going = [&watch] { return watch.keep_going(); };
    return run_method(*chosen, input);
  });
}

py::list methods() {
  return list_of(all_methods(), [](const Method* method) {
    const MethodTraits traits = method->traits();
    return py::dict("name"_a = traits.name, "summary"_a = traits.summary, "needs"_a = traits.needs,
                    "gives"_a = traits.gives);
  });
}

void add_view_poses(py::module_& module) {
  py::class_<ViewPose>(module, "ViewPose", "The board's pose in one camera at one stop.")
      .def_readonly("view", &ViewPose::view, "Index into Observations.board_views")
      .def_readonly("stop", &ViewPose::stop)
      .def_readonly("camera", &ViewPose::camera)
      .def_property_readonly("T_camera_board", copy_of(&ViewPose::T_camera_board))
      .def_property_readonly(
          "covariance", [](const ViewPose& view) { return array_of(view.covariance); },
          "(6, 6) in the chart of transform_error()")
      .def_readonly("board", &ViewPose::board)
      .def_readonly("reprojection_rms_px", &ViewPose::reprojection_rms_px);
  module.def(
      "view_poses", [](const Observations& observations) { return estimate_view_poses(observations).poses; },
      py::arg("observations"), py::call_guard<py::gil_scoped_release>(),
      "The board's pose in each view, sorted by stop, then camera (IPPE, refined on the reprojection error). Views\n"
      "whose pose cannot be found are left out.");
}

std::pair<Observations, Truth> draw(std::uint64_t seed, int stops, double corner_sigma_px, double lambda) {
  if (stops < 1 || stops > 1000000 || !(corner_sigma_px >= 0.0) || !(lambda >= 0.0))
    throw py::value_error("stops: 1 to 1000000; corner_sigma_px and odometry_lambda: 0 and more");
  const py::gil_scoped_release released;
  GeometricConfig config;
  config.seed = seed;
  config.stops = stops;
  config.corner_sigma_px = corner_sigma_px;
  config.lambda = lambda;
  GeometricRun run = draw_geometric_run(config);
  return {std::move(run.observations), std::move(run.truth)};
}

}  // namespace

std::optional<py::error_already_set> look_at_python(const Watch& watch, const py::object& progress) {
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none() && watch.all() > 0) progress(watch.done(), watch.all());
    return std::nullopt;
  } catch (const py::error_already_set& error) {
    return error;
  }
}

void add_work(py::module_& module) {
  add_input(module);
  add_view_poses(module);
  module.def(
      "open", [](const std::filesystem::path& path) { return open_input(path); }, py::arg("path"),
      py::call_guard<py::gil_scoped_release>(),
      "Opens a run, a recording, a foreign layout or observations.json. Throws Error with every problem found.");
  module.def("observe", observe_data, py::arg("data"), py::arg("threads") = 0, py::arg("progress") = py::none(),
             "Looks for board and planes in the images of an Input or path; as `rigproof observe`.\n"
             "progress(done, all) is called several times a second; what it raises ends the work. Ctrl-C works.");
  module.def("calibrate", calibrate, py::arg("data"), py::arg("method") = "ml", py::arg("threads") = 0,
             py::arg("progress") = py::none(),
             "Solves for the pose of every camera, as `rigproof calibrate`; writes nothing.\n\n"
             "data: Observations, or an Input or path, whose images are looked at first.\n"
             "method: as `rigproof methods` names them, external:FILE.yaml, ml:KEY=VALUE, or a function that takes\n"
             "Observations and returns a Result, or a dict of T_robot_camera (Pose or (4, 4)) by camera.\n"
             "What cannot be answered is a refused or partial Result; Error is for bad input.");
  module.def("methods", methods, "All methods: name, summary, needs, gives.");
  module.def("draw", draw, py::arg("seed") = 0, py::arg("stops") = 100, py::arg("corner_sigma_px") = 0.1,
             py::arg("odometry_lambda") = 1.0,
             "(Observations, Truth) of the reference rig of three cameras, drawn from a noise model without images.\n"
             "odometry_lambda: multiple of 2 mm and 0.01 rad an increment.");
  module.def("data_folder", data_folder, "Where scenes, models and configurations lie.");
}

}  // namespace rigproof::python
