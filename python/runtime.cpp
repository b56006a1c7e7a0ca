// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/runtime/compensator.hpp"

namespace elastocal::python {
namespace {

/// A calibrated robot for a controller. Only one thread may use an object at a time.
class PyRuntime {
 public:
  PyRuntime(const Path& calibration, const Path& project, const std::string& content)
      : compensator_(Make(calibration, project, content)) {}

  const RuntimeModel& model() const { return compensator_.model(); }

  py::dict Forward(const py::object& q, const Eigen::VectorXd& torque, StandingFeet feet) {
    status_ = compensator_.Forward(Positions(q), Checked(torque), feet);
    py::dict poses;
    for (std::size_t i = 0; i < model().link_names.size(); ++i) {
      poses[py::str(model().link_names[i])] =
          Eigen::Matrix4d(compensator_.link_pose(static_cast<int>(i)).matrix());
    }
    py::dict result;
    result["links"] = poses;
    result["root"] = Eigen::Matrix4d(compensator_.root_pose().matrix());
    result["status"] = Status();
    return result;
  }

  Eigen::VectorXd Command(const py::object& q, const Eigen::VectorXd& torque, StandingFeet feet) {
    ExpectTips();
    status_ = compensator_.Command(Positions(q), Checked(torque), feet);
    return compensator_.command();
  }

  Eigen::VectorXd Correct(const py::object& q, const Eigen::VectorXd& torque, StandingFeet feet) {
    ExpectTips();
    status_ = compensator_.Correct(Positions(q), Checked(torque), feet);
    return compensator_.rigid_positions();
  }

  void Forget() { compensator_.Forget(); }

  void StartFrom(const py::object& command) {
    if (!compensator_.StartFrom(Positions(command))) {
      throw InputError("command: finite positions were expected");
    }
  }

  void LimitChanges(const Eigen::VectorXd& most) {
    if (!compensator_.LimitChanges(most)) {
      throw InputError("most: " + std::to_string(most.size()) + " limits; none or " +
                       std::to_string(model().coordinate_names.size()) + " were expected");
    }
  }

  void EaseChanges(double calls) { compensator_.EaseChanges(calls); }

  const Compensator& compensator() const { return compensator_; }

  std::string Status() const { return DescribeStatus(status_); }

  std::vector<std::string> Stopped() const {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < model().coordinate_names.size(); ++c) {
      if (compensator_.stopped()[c] != 0) names.push_back(model().coordinate_names[c]);
    }
    return names;
  }

 private:
  static RuntimeModel Make(const Path& calibration, const Path& project,
                           const std::string& content) {
    const auto wanted = Named<RuntimeContent>("content", content,
                                              {{"nominal", RuntimeContent::kNominal},
                                               {"geometry", RuntimeContent::kGeometry},
                                               {"everything", RuntimeContent::kEverything}});
    const CalibratedRobot robot = OpenCalibratedRobot(calibration, project);
    return MakeRuntimeModel(robot.project, robot.calibration, wanted);
  }

  Eigen::VectorXd Positions(const py::object& q) const {
    return PositionsOf(q, model().coordinate_names, "q");
  }

  const Eigen::VectorXd& Checked(const Eigen::VectorXd& torque) const {
    if (torque.size() == 0 || torque.size() == model().joint_count()) return torque;
    throw InputError("torque: " + std::to_string(torque.size()) + " torques; none or " +
                     std::to_string(model().joint_count()) + " were expected");
  }

  void ExpectTips() const {
    if (model().tips.empty()) throw InputError(NothingToCorrect());
  }

  Compensator compensator_;
  CompensatorStatus status_ = {};
};

constexpr const char* kArguments =
    " q: (joints,), rad or m, or a dict of joints, the others being at 0. torque: (all joints of "
    "the robot,), N.m, measured; empty: those of gravity. feet: bit i for foot i that stands.";

}  // namespace

void AddRuntime(py::module_& module) {
  const Eigen::VectorXd none;
  const auto with_arguments = [](const std::string& what) { return what + kArguments; };
  py::class_<PyRuntime>(module, "Runtime",
                        "The calibrated robot in a controller. One thread at a time.")
      .def(py::init<const Path&, const Path&, const std::string&>(), "calibration"_a,
           "project"_a = "", "content"_a = "everything", py::call_guard<LongCall>(),
           "calibration: the folder that calibrate wrote. content: 'everything', 'geometry' "
           "(without elasticity) or 'nominal'.")
      .def_property_readonly(
          "joints", [](const PyRuntime& r) { return r.model().coordinate_names; },
          "Joints that are entries of q, in its order.")
      .def_property_readonly(
          "links", [](const PyRuntime& r) { return r.model().link_names; }, "Names of all links.")
      .def_property_readonly(
          "feet", [](const PyRuntime& r) { return r.model().foot_names; },
          "Links of the feet, in the order of the bits of `feet`.")
      .def_property_readonly("status", &PyRuntime::Status,
                             "What the last call had to cut or replace, in words; also of q that "
                             "is not finite, where the last good answer is given.")
      .def_property_readonly(
          "residual_m", [](const PyRuntime& r) { return r.compensator().residual_m(); },
          "What the last command leaves at the ends of the limbs, m.")
      .def_property_readonly(
          "residual_rad", [](const PyRuntime& r) { return r.compensator().residual_rad(); },
          "What the last command leaves at the ends of the limbs, rad.")
      .def_property_readonly("stopped", &PyRuntime::Stopped,
                             "Joints whose limit, or the limit of whose correction, keeps the end "
                             "of a limb from its place after the last command.")
      .def_property_readonly(
          "root_displacement",
          [](const PyRuntime& r) -> Eigen::VectorXd { return r.compensator().root_displacement(); },
          "Of the last correct: how far the root link is from that of the rigid robot on the same "
          "feet, (6,): translation in m, then rotation vector in rad, in the axes of the first "
          "foot that stands.")
      .def(
          "forget", &PyRuntime::Forget,
          "Lets the next command be found by itself, and forgets the last input. Commands near the "
          "last one go on from it, as along a motion.")
      .def("start_from", &PyRuntime::StartFrom, "command"_a,
           "Begins a motion from the command at which the drives are, q as in 'command': "
           "limit_changes holds from the next command on.")
      .def("limit_changes", &PyRuntime::LimitChanges, "most"_a,
           "Limits the change of a command from one call to the next, (joints,), rad or m: the "
           "largest speed times the time between calls. A joint that the plan moves further moves "
           "as far as the plan. Negative or NaN: no limit; empty: none at all.")
      .def("ease_changes", &PyRuntime::EaseChanges, "calls"_a,
           "Lets a correction take so many calls to reach its largest speed, a tenth of that of "
           "limit_changes, and as many to brake. 0: corrections are given at once.")
      .def("forward", &PyRuntime::Forward, "q"_a, "torque"_a = none, "feet"_a = 0u,
           with_arguments("Poses (4, 4) in m of all 'links' in the root link's frame, with "
                          "deflection, of the 'root', and the 'status'.")
               .c_str())
      .def("command", &PyRuntime::Command, "q"_a, "torque"_a = none, "feet"_a = 0u,
           with_arguments("Positions (joints,) to command so that hands and feet go where the "
                          "nominal robot has them at q.")
               .c_str())
      .def("correct", &PyRuntime::Correct, "q"_a, "torque"_a = none, "feet"_a = 0u,
           with_arguments("Positions (joints,) at which a rigid calibrated robot has its hands "
                          "where the real one has them (its URDF: `elastocal export --format urdf "
                          "--beside-springs`).")
               .c_str());
}

}  // namespace elastocal::python
