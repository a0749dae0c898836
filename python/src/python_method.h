// A Python function as a calibration method.
#pragma once

#include "bindings.h"
#include "rigproof/calib/diagnose/method.h"

namespace rigproof::python {

class PythonMethod : public Method {
 public:
  /// @param function takes Observations; returns a Result, or a dict of T_robot_camera by camera
  /// Throws TypeError for what cannot be called.
  explicit PythonMethod(py::object function);
  ~PythonMethod() override;
  PythonMethod(const PythonMethod&) = delete;
  PythonMethod& operator=(const PythonMethod&) = delete;

  MethodTraits traits() const override;
  /// Changes with the function's code.
  std::string settings_text() const override;
  /// What the function raises is the reason of a refused result, as for a program that breaks.
  Result solve(const Observations& observations) const override;

  /// The same with Python's lock held; what the function raises is thrown.
  Result call(const Observations& observations) const;

 private:
  py::object function_;
  std::string name_;
  bool several_boards_ = false;  ///< the function has an attribute of this name that is true
};

}  // namespace rigproof::python
