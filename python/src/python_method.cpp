#include "python_method.h"

#include <algorithm>

#include "answers.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/study/workflow/external.h"

namespace rigproof::python {
namespace {

void check_cameras(const Result& result, const Observations& observations, const std::string& name) {
  for (const EstimatedTransform& transform : result.camera_to_robot) {
    const auto is_it = [&](const RigCamera& camera) {
      return camera.name == transform.child || camera.name == transform.parent;
    };
    if (std::none_of(observations.cameras.begin(), observations.cameras.end(), is_it))
      throw py::value_error(name + ": gives a pose of " + transform.child + ", which is no camera of the rig");
  }
}

// Cameras without a pose are not answered.
void say_what_is_missing(const Observations& observations, Result* result) {
  if (result->status != ResultStatus::kSolved) return;
  for (const RigCamera& camera : observations.cameras) {
    if (result->find(observations.robot_frame, camera.name) != nullptr ||
        result->find(camera.name, observations.robot_frame) != nullptr)
      continue;
    result->status = ResultStatus::kPartial;
    result->reasons.push_back(Finding("program.no_pose").of(camera.name));
  }
}

// Code and constants, so that an edited function is another method.
std::string code_of(const py::object& function) {
  const py::object code = py::getattr(function, "__code__", py::none());
  const py::bytes bytes = py::module_::import("marshal").attr("dumps")(code.is_none() ? py::str("") : code);
  return bytes;
}

}  // namespace

PythonMethod::PythonMethod(py::object function) : function_(std::move(function)) {
  if (PyCallable_Check(function_.ptr()) == 0)
    throw py::type_error("a method must be a name or a function that takes Observations");
  name_ = py::str(py::getattr(function_, "__name__", py::type::of(function_).attr("__name__")));
  if (!is_word(name_)) name_ = "function";  // "<lambda>"
  several_boards_ = py::bool_(py::getattr(function_, "several_boards", py::bool_(false)));
}

PythonMethod::~PythonMethod() {
  const py::gil_scoped_acquire acquired;
  function_ = py::object();
}

MethodTraits PythonMethod::traits() const {
  MethodTraits traits = {name_, "a Python function", "as it says", "as it says", MethodReads::kObservations};
  traits.several_boards = several_boards_;
  return traits;
}

std::string PythonMethod::settings_text() const {
  const py::gil_scoped_acquire acquired;
  return sha256_hex(name_ + " " + code_of(function_));
}

Result PythonMethod::call(const Observations& observations) const {
  const py::object answer = function_(py::cast(observations));
  Result result;
  if (py::isinstance<Result>(answer))
    result = answer.cast<Result>();
  else if (py::isinstance<py::dict>(answer))
    result = result_of_poses(name_, answer, observations.robot_frame, py::dict());
  else
    throw py::type_error(name_ + ": returned " + py::str(py::type::of(answer).attr("__name__")).cast<std::string>() +
                         "; allowed is a Result, or a dict of poses by camera");
  check_cameras(result, observations, name_);
  say_what_is_missing(observations, &result);
  result.method = name_;
  return result;
}

Result PythonMethod::solve(const Observations& observations) const {
  const py::gil_scoped_acquire acquired;
  try {
    return call(observations);
  } catch (py::error_already_set& error) {
    if (error.matches(PyExc_KeyboardInterrupt)) throw Error("interrupted", ExitCode::kTryAgain);
    Result result;
    result.method = name_;
    result.reasons.push_back(Finding("program.failed", {{"text", std::string("raised ") + error.what()}}));
    return result;
  } catch (const py::builtin_exception& error) {
    Result result;
    result.method = name_;
    result.reasons.push_back(Finding("program.bad_answer", {{"text", error.what()}}));
    return result;
  }
}

}  // namespace rigproof::python
