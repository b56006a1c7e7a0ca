// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bindings.hpp"
#include "elastocal/files/bounds.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal::python {

LongCall::LongCall()
    : interruptible_([] {
        const py::gil_scoped_acquire locked;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      }) {}

py::object FromJson(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}

namespace {

/// Raises TypeError with the expected type for an object of another type.
template <typename Value>
Value Cast(const py::handle& object, const std::string& expected) {
  try {
    return object.cast<Value>();
  } catch (const py::cast_error&) {
    throw py::type_error(expected + " was expected, found " +
                         py::cast<std::string>(py::str(py::type::of(object).attr("__name__"))));
  }
}

bool IsPath(const py::handle& object) {
  return py::isinstance<py::str>(object) ||
         py::isinstance(object, py::module_::import("os").attr("PathLike"));
}

}  // namespace

Project ProjectOf(const py::handle& given) {
  if (py::isinstance<Project>(given)) return given.cast<const Project&>();
  if (IsPath(given)) return ReadProject(given.cast<Path>());
  return Cast<const Project&>(given, "project: a Project, or its file (str or Path),");
}

Paths PathsOf(const py::object& paths) {
  if (IsPath(paths)) return {paths.cast<Path>()};
  return Cast<Paths>(paths, "a file (str or Path), or a list of files,");
}

Eigen::VectorXd PositionsOf(const py::object& q, const Names& coordinates,
                            const std::string& what) {
  const auto count = static_cast<Eigen::Index>(coordinates.size());
  if (!py::isinstance<py::dict>(q)) {
    const auto positions = Cast<Eigen::VectorXd>(
        q, what + ": an array of " + std::to_string(count) + " positions, or a dict of joints");
    if (positions.size() == count) return positions;
    throw InputError(what + ": " + std::to_string(positions.size()) + " positions; " +
                     std::to_string(count) + " were expected");
  }
  Eigen::VectorXd positions = Eigen::VectorXd::Zero(count);
  for (const auto& [key, value] : q.cast<py::dict>()) {
    const auto name = Cast<std::string>(key, what + ": the name of a joint");
    const auto at = std::find(coordinates.begin(), coordinates.end(), name);
    if (at == coordinates.end()) {
      throw InputError(what + ": no joint " + Quote(name) + DidYouMean(name, coordinates));
    }
    positions[at - coordinates.begin()] =
        Cast<double>(value, what + ": joint " + Quote(name) + ": a number");
  }
  return positions;
}

Names CoordinateNames(const RobotTree& tree) {
  Names names;
  for (int joint : tree.coordinate_joint) names.push_back(tree.joints[joint].name);
  return names;
}

void ExpectBounded(const std::string& option, double value) {
  const NumberRange range = BoundsOf(option);
  if (range.Contains(value)) return;
  std::string argument = option.substr(option.find("--") + 2);
  std::replace(argument.begin(), argument.end(), '-', '_');
  throw InputError(argument + ": " + FormatNumber(value) + "; " + range.InWords() +
                   " was expected");
}

void ExpectWithin(const char* argument, long long value, long long least, long long most) {
  if (value >= least && value <= most) return;
  throw InputError(std::string(argument) + ": " + std::to_string(value) + "; a whole number from " +
                   std::to_string(least) + " to " + std::to_string(most) + " was expected");
}

}  // namespace elastocal::python
