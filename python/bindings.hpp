// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/robot_tree.hpp"

// Declarations that the parts of the Python module share. Each part adds classes and functions of
// one subject.

namespace elastocal::python {

namespace py = pybind11;
using py::literals::operator""_a;

using Path = std::filesystem::path;
using Paths = std::vector<Path>;
using Names = std::vector<std::string>;

void AddRobot(py::module_& module);        ///< Robot, Project
void AddCalibrating(py::module_& module);  ///< calibrate, validate, check, compare
void AddRecordings(py::module_& module);   ///< read, info, write_table
void AddDesigning(py::module_& module);    ///< design, design_after
void AddMotions(py::module_& module);      ///< plan
void AddSimulating(py::module_& module);   ///< simulate
void AddRuntime(py::module_& module);      ///< Runtime
void AddUsing(py::module_& module);        ///< export, compensate
void AddBatches(py::module_& module);      ///< batch

/// There is no result: the limits allow no posture or no motion. In Python
/// `elastocal.InfeasibleError`.
struct Infeasible : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Behaviour of a long call: other Python threads may run, and the call ends when a signal's
/// handler raises, for instance that of Ctrl-C. No Python object may be used while this lives.
class LongCall {
 public:
  LongCall();

 private:
  py::gil_scoped_release unlocked_;
  Interruptible interruptible_;
};

/// Runs work as a long call.
template <typename Work>
auto Unlocked(const Work& work) {
  const LongCall guard;
  return work();
}

/// The dict of a JSON text.
py::object FromJson(const std::string& text);

/// One or several paths.
Paths PathsOf(const py::object& paths);

/// A project argument: a Project, or the file of one.
struct ProjectOrFile {
  Project project;
};

/// Raises TypeError for other types, and throws InputError for a bad file.
Project ProjectOf(const py::handle& given);

/// Positions by coordinate of the tree [rad or m], from an array, or from a dict of joints, in
/// which missing joints are at zero. Throws InputError with `what` for another size or an unknown
/// joint.
Eigen::VectorXd PositionsOf(const py::object& q, const Names& coordinates, const std::string& what);

/// Names of the joints that are entries of q, in its order.
Names CoordinateNames(const RobotTree& tree);

/// Throws InputError for a value outside the bounds of a command-line option ("plan --move-s"). The
/// message names the argument of the same name (move_s).
void ExpectBounded(const std::string& option, double value);
/// The same check for a count.
void ExpectWithin(const char* argument, long long value, long long least, long long most);

/// The entry with a name. Throws InputError with all names if there is none.
template <typename Value>
const Value& Named(const char* argument, const std::string& name,
                   const std::vector<std::pair<const char*, Value>>& values) {
  std::string all;
  for (const auto& [known, value] : values) {
    if (name == known) return value;
    all += (all.empty() ? "'" : ", '") + std::string(known) + "'";
  }
  throw InputError(std::string(argument) + ": '" + name + "'; one of " + all + " was expected");
}

}  // namespace elastocal::python

namespace pybind11::detail {

template <>
struct type_caster<elastocal::python::ProjectOrFile> {
  PYBIND11_TYPE_CASTER(elastocal::python::ProjectOrFile, const_name("elastocal.Project"));

  bool load(handle given, bool) {
    value.project = elastocal::python::ProjectOf(given);
    return true;
  }
};

}  // namespace pybind11::detail
