// The answer against the truth.
#include "bindings.h"
#include "rigproof/study/workflow/workflow.h"
#include "rigproof/validate/bound.h"
#include "rigproof/validate/budget.h"
#include "rigproof/validate/format.h"
#include "rigproof/validate/validate.h"
#include "rigproof/words/sentences.h"

namespace rigproof::python {
namespace {

/// A judged result.
struct Validation {
  Verdict verdict;
  Budget budget;
};

Validation validate(const Result& result, const Truth& truth, const std::optional<std::string>& budget) {
  Validation validation;
  validation.budget = budget_of(budget.value_or(""));
  validation.verdict = judge(result, truth, validation.budget);
  return validation;
}

py::array_t<double> z_of(const TransformError& error) {
  Vector6d z;
  for (int i = 0; i < 6; ++i) z(i) = error.z(i).value_or(kNaN);
  return array_of(z);
}

void add_errors_of_transforms(py::module_& module) {
  py::class_<TransformError>(module, "TransformError", "Error of one transform, in the chart of transform_error().")
      .def_readonly("parent", &TransformError::parent)
      .def_readonly("child", &TransformError::child)
      .def_property_readonly("name", &TransformError::name)
      .def_readonly("between_cameras", &TransformError::between_cameras)
      .def_property_readonly(
          "error", [](const TransformError& e) { return array_of(e.error); },
          "(6,) [m, rad]; zero where not observable")
      .def_property_readonly(
          "sigma", [](const TransformError& e) { return e.sigma ? py::object(array_of(*e.sigma)) : py::none(); },
          "(6,), as stated; None if the method states none")
      .def_property_readonly("z", z_of, "error / sigma (6,); NaN where there is none")
      .def_property_readonly("observable", [](const TransformError& e) { return array_of(e.observable); })
      .def_property_readonly("T_estimate", copy_of(&TransformError::T_estimate))
      .def_property_readonly("T_true", copy_of(&TransformError::T_true));
  py::class_<Check>(module, "Check", "One limit against one error.")
      .def_readonly("name", &Check::name)
      .def_readonly("passed", &Check::passed)
      .def_readonly("value", &Check::value)
      .def_readonly("limit", &Check::limit)
      .def_readonly("unit", &Check::unit, "cm, deg or sigma; empty where there is no value")
      .def("__str__", [](const Check& check) { return check.message(words::sentence_of); });
}

void add_validation_class(py::module_& module) {
  py::class_<Validation>(module, "Validation", "A result against the truth; str() is what `rigproof validate` prints.")
      .def_property_readonly("passed", [](const Validation& v) { return v.verdict.gate.passed(); })
      .def_property_readonly("checks", [](const Validation& v) { return v.verdict.gate.checks; })
      .def_property_readonly("camera_to_robot",
                             [](const Validation& v) { return v.verdict.comparison.camera_to_robot; })
      .def_property_readonly("camera_to_camera",
                             [](const Validation& v) { return v.verdict.comparison.camera_to_camera; })
      .def_property_readonly("missing_cameras",
                             [](const Validation& v) { return v.verdict.comparison.missing_cameras; })
      .def_property_readonly(
          "nees", [](const Validation& v) { return v.verdict.comparison.nees; },
          "Of all cameras together; None without a joint covariance")
      .def_property_readonly("nees_degrees_of_freedom",
                             [](const Validation& v) { return v.verdict.comparison.nees_degrees_of_freedom; })
      .def_property_readonly(
          "suspicion", [](const Validation& v) { return format_suspicion(v.verdict.comparison, words::sentence_of); },
          "A wrong convention that explains the errors, in a sentence; empty without")
      .def("__str__", [](const Validation& v) {
        return format_validation(v.verdict.comparison, v.verdict.gate, v.budget, v.verdict.comparison.method,
                                 words::sentence_of);
      });
}

py::list bound(const Observations& observations, const Truth& truth) {
  std::vector<TransformBound> bounds;
  {
    const py::gil_scoped_release released;
    bounds = transform_bounds(observations, truth);
  }
  return list_of(bounds, [](const TransformBound& one) {
    return py::dict("parent"_a = one.parent, "child"_a = one.child, "sigma"_a = array_of(one.sigma));
  });
}

}  // namespace

void add_validation(py::module_& module) {
  add_errors_of_transforms(module);
  add_validation_class(module);
  module.def("validate", validate, py::arg("result"), py::arg("truth"), py::arg("budget") = py::none(),
             py::call_guard<py::gil_scoped_release>(),
             "Compares a Result with a Truth under a budget: a file, or ci, paper, honest; default 4 stated sigmas.\n"
             "With a budget, a result that its own findings throw doubt on (severity suspect) fails, too.\n"
             "Throws Error for names that the truth does not know.");
  module.def(
      "bound", bound, py::arg("observations"), py::arg("truth"),
      "The Cramer-Rao bound of these observations at the truth: a list of {parent, child, sigma (6,) [m, rad]},\n"
      "each camera in the robot, then each pair; NaN where the data leave an axis open. Empty if a camera or stop\n"
      "of the observations is not in the truth.");
}

}  // namespace rigproof::python
