// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal::python {
namespace {

/// A limit for each entry of q.
template <typename Get>
Eigen::VectorXd ByCoordinate(const RobotTree& tree, const Get& get) {
  Eigen::VectorXd values(tree.coordinate_count());
  for (int i = 0; i < tree.coordinate_count(); ++i) {
    values[i] = get(tree.joints[tree.coordinate_joint[i]].limits);
  }
  return values;
}

py::dict LinkPoses(const RobotTree& tree, const py::object& q) {
  const std::vector<Transform> poses =
      LinkTransforms(tree, PositionsOf(q, CoordinateNames(tree), "q"));
  py::dict result;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    result[py::str(tree.links[i].name)] = Eigen::Matrix4d(poses[i].matrix());
  }
  return result;
}

/// Names of the elements of a list.
template <typename Things>
Names NamesOf(const Things& things) {
  Names names;
  for (const auto& thing : things) names.push_back(thing.name);
  return names;
}

/// The limits of all entries of q.
auto LimitsOf(double JointLimits::*limit) {
  return [limit](const RobotTree& r) {
    return ByCoordinate(r, [limit](const JointLimits& limits) { return limits.*limit; });
  };
}

void AddTree(py::module_& module) {
  py::class_<RobotTree>(module, "Robot", "A nominal robot, as its URDF describes it.")
      .def_property_readonly(
          "name", [](const RobotTree& r) { return r.name; }, "As in the URDF.")
      .def_property_readonly("joints", CoordinateNames,
                             "Joints that are entries of q, in its order; mimic joints are not.")
      .def_property_readonly(
          "links", [](const RobotTree& r) { return NamesOf(r.links); }, "The root link first.")
      .def_property_readonly("lower", LimitsOf(&JointLimits::lower),
                             "Least positions (joints,), rad or m; -inf without a limit.")
      .def_property_readonly("upper", LimitsOf(&JointLimits::upper),
                             "Largest positions (joints,), rad or m; inf without a limit.")
      .def_property_readonly("velocity", LimitsOf(&JointLimits::velocity),
                             "Largest speeds (joints,), rad/s or m/s.")
      .def_property_readonly("effort", LimitsOf(&JointLimits::effort),
                             "Largest torques (joints,), N.m, or forces, N.")
      .def("poses", LinkPoses, "q"_a,
           "Poses (4, 4) of all links in the root link's frame, by name, without deflection. q: "
           "(joints,), rad or m, or a dict of joints, the others being at 0.");
}

void AddProject(py::module_& module) {
  py::class_<Project>(module, "Project", "A project file with its robot.")
      .def("__repr__",
           [](const Project& project) {
             return "<elastocal.Project '" + project.file.string() + "': robot " +
                    project.tree.name + ", " + std::to_string(project.tree.coordinate_count()) +
                    " joints, " + std::to_string(project.chains.size()) + " chains, " +
                    std::to_string(project.markers.size()) + " markers>";
           })
      .def(py::init([](const Path& file) { return ReadProject(file); }), "file"_a,
           py::call_guard<LongCall>(), "Reads a project file (YAML; docs/formats.md).")
      .def_property_readonly(
          "robot", [](const Project& p) -> const RobotTree& { return p.tree; },
          py::return_value_policy::reference_internal, "Its nominal robot.")
      .def_property_readonly(
          "file", [](const Project& p) { return p.file.string(); }, "The project file.")
      .def(
          "__fspath__", [](const Project& p) { return p.file.string(); },
          "The project file, so that a project can be given wherever its file can.")
      .def_property_readonly(
          "urdf", [](const Project& p) { return p.urdf.string(); }, "The robot description.")
      .def_property_readonly(
          "joints", [](const Project& p) { return CoordinateNames(p.tree); },
          "Joints that are entries of q, in its order.")
      .def_property_readonly(
          "chains", [](const Project& p) { return NamesOf(p.chains); },
          "Names of the chains that are calibrated.")
      .def_property_readonly(
          "markers", [](const Project& p) { return NamesOf(p.markers); }, "Names of all markers.")
      .def_property_readonly(
          "rest", [](const Project& p) { return p.motion.rest; },
          "Posture of rest (joints,), rad or m: of joints that a posture leaves out.");
}

}  // namespace

void AddRobot(py::module_& module) {
  AddTree(module);
  AddProject(module);
}

}  // namespace elastocal::python
