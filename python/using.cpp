// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"
#include "elastocal/exports/export_calibration.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/compensate_motion.hpp"
#include "elastocal/planning/expected_errors.hpp"
#include "elastocal/report/version.hpp"
#include "motions.hpp"

namespace elastocal::python {
namespace {

Names Export(const Path& calibration, const std::string& format, const Path& file,
             const Path& project, const std::string& prefix, const Path& mjcf,
             const Names& mjcf_joints, bool mjcf_springs, double min_significance,
             std::optional<double> min_gain, bool beside_springs,
             std::optional<double> hip_damping) {
  if (file.empty()) throw InputError("file: a name was expected");
  ExportOptions options{.format = format,
                        .prefix = prefix,
                        .least_significance = min_significance,
                        .version = ProgramVersion(),
                        .mjcf = mjcf,
                        .mjcf_joints = mjcf_joints,
                        .output = file,
                        .mjcf_springs = mjcf_springs,
                        .beside_springs = beside_springs,
                        .hip_damping = hip_damping};
  if (min_gain) options.least_gain = 1e-3 * *min_gain;
  return Unlocked([&] {
    const CalibratedRobot robot = OpenCalibratedRobot(calibration, project);
    OutputSet outputs;
    outputs.Protect(robot.inputs);
    if (!mjcf.empty()) outputs.Protect({mjcf});
    outputs.Protect(RecordedFiles(robot));
    outputs.Declare(file, IsExported);
    outputs.Prepare();
    const ExportedCalibration exported = ExportCalibration(robot, options);
    outputs.Set(file, exported.text);
    outputs.Publish();
    return exported.notes;
  });
}

/// A motion that was corrected in this process.
struct PyCompensation {
  CalibratedRobot robot;
  CompensatedMotion result;
};

PyCompensation Compensate(const Path& calibration, const py::object& motion, const Path& project,
                          const std::string& content, const std::string& loads, double most_left_mm,
                          double most_turned_deg) {
  const auto with = Named<MotionLoads>(
      "loads", loads, {{"statics", MotionLoads::kStatics}, {"planned", MotionLoads::kPlanned}});
  const auto wanted = Named<RuntimeContent>(
      "content", content,
      {{"geometry", RuntimeContent::kGeometry}, {"everything", RuntimeContent::kEverything}});
  PyCompensation made{OpenCalibratedRobot(calibration, project), {}};
  const JointMotion given = MotionOf(motion, made.robot.project);
  const LongCall guard;
  made.result =
      CompensateMotion(made.robot.project,
                       MakeRuntimeModel(made.robot.project, made.robot.calibration, wanted), given,
                       {.loads = with,
                        .most_left_m = 1e-3 * most_left_mm,
                        .most_turned_rad = most_turned_deg * M_PI / 180.0});
  made.result.expected = ExpectErrors(made.robot, made.result.planned.motion);
  std::string why;
  for (const std::string& reason : made.result.broken) why += (why.empty() ? "" : "; ") + reason;
  if (!why.empty()) throw Infeasible("the corrected motion must not be played: " + why);
  return made;
}

void SaveCompensation(const PyCompensation& made, const Path& file) {
  const RobotTree& tree = made.robot.project.tree;
  OutputSet outputs;
  outputs.Protect(made.robot.inputs);
  outputs.Protect(RecordedFiles(made.robot));
  outputs.Declare(file, [&](const std::string& text) { return IsMotionTable(tree, text); });
  outputs.Prepare();
  outputs.Set(file, FormatMotionTable(tree, made.result.planned));
  outputs.Publish();
}

}  // namespace

void AddUsing(py::module_& module) {
  module.def(
      "export", Export, "calibration"_a, "format"_a, "file"_a, py::kw_only(), "project"_a = "",
      "prefix"_a = "", "mjcf"_a = "", "mjcf_joints"_a = Names(), "mjcf_springs"_a = false,
      "min_significance"_a = 0.0, "min_gain_mm"_a = std::nullopt, "beside_springs"_a = false,
      "hip_damping"_a = std::nullopt,
      "Writes a saved calibration in a form that controllers and ROS read, like the command of "
      "that name: format 'urdf', 'c99', 'mjcf' and so on (docs/deploy.md). Returns its notes: what "
      "stays nominal, and why. Other arguments are those of the command.");
  py::class_<PyCompensation>(module, "Compensation",
                             "A planned motion that compensate() corrected.")
      .def_property_readonly(
          "time_s", [](const PyCompensation& c) { return c.result.planned.motion.time_s; },
          "(samples,), s.")
      .def_property_readonly(
          "positions", [](const PyCompensation& c) { return c.result.planned.motion.q; },
          "To command, (samples, joints), rad or m, by Project.joints.")
      .def_property_readonly(
          "summary",
          [](const PyCompensation& c) { return FromJson(MakeCompensationJson(c.result)); },
          "The dict of `elastocal compensate --json`: largest correction, what is left, margins.")
      .def("save", SaveCompensation, "file"_a, "Writes the motion (CSV).",
           py::call_guard<LongCall>());
  module.def(
      "compensate", Compensate, "calibration"_a, "motion"_a, py::kw_only(), "project"_a = "",
      "content"_a = "everything", "loads"_a = "statics",
      "most_left_mm"_a = 1e3 * CompensateMotionOptions{}.most_left_m,
      "most_turned_deg"_a = CompensateMotionOptions{}.most_turned_rad * 180.0 / M_PI,
      "Corrects a planned motion so that hands, feet and waist go where the plan meant, like the "
      "command of that name. motion: a Plan, a file (CSV), or a dict of time_s, positions and "
      "perhaps support. content: 'everything', or 'geometry' (without elasticity). loads: "
      "'statics', or 'planned' for fast motion. Raises InfeasibleError where a limit would be "
      "broken, or more than most_left_mm is left at the end of a limb (a degree counts 5.2 mm, of "
      "an arm with too few joints 0.5 mm; its hand may be turned by most_turned_deg).");
}

}  // namespace elastocal::python
