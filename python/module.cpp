// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <utility>

#include "bindings.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/report/version.hpp"

PYBIND11_MODULE(elastocal, module) {
  using namespace elastocal;
  namespace py = pybind11;
  module.doc() =
      "Elasto-geometric calibration of robots. SI units and radians everywhere; arrays are "
      "NumPy's, "
      "files are str or Path. Long calls let other threads run and end on Ctrl-C.";
  module.attr("__version__") = ProgramVersion();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const py::cast_error&) {
      PyErr_SetString(PyExc_TypeError,
                      "an argument, or a part of it, has a type that was not expected");
    }
  });
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).attr("__doc__") =
      "A file or value that cannot be used: where, what was found and what was expected.";
  py::register_exception<python::Infeasible>(module, "InfeasibleError", PyExc_RuntimeError)
      .attr("__doc__") = "The limits leave no posture or no motion: which, and why.";
  python::AddRobot(module);
  python::AddCalibrating(module);
  python::AddRecordings(module);
  python::AddDesigning(module);
  python::AddMotions(module);
  python::AddSimulating(module);
  python::AddRuntime(module);
  python::AddUsing(module);
  python::AddBatches(module);
}
