// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <optional>
#include <thread>

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/io/recorded_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/check_calibration.hpp"
#include "elastocal/pipeline/compare_calibrations.hpp"
#include "elastocal/pipeline/recording_info.hpp"
#include "elastocal/pipeline/runtime_robot.hpp"
#include "elastocal/pipeline/summary.hpp"
#include "elastocal/pipeline/validate_calibration.hpp"
#include "elastocal/report/version.hpp"
#include "elastocal/runtime/compensator.hpp"

namespace py = pybind11;

namespace elastocal {
namespace {

using Path = std::filesystem::path;
using Paths = std::vector<Path>;

py::object FromJson(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}

/// Ends a long call on Ctrl-C: the signal is looked for whenever a part of the work is done, on the
/// thread that called.
StepProgress StopOnSignals() {
  return [caller = std::this_thread::get_id()](const std::string&, int, int) {
    if (std::this_thread::get_id() != caller) return;
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  };
}

/// A calibration that was made in this process.
struct PyCalibration {
  Project project;
  CalibrationRun run;
  std::map<std::string, std::string> files;

  const CalibrationResult& result() const { return run.comparison.largest(); }
};

PyCalibration CalibrateFiles(const Project& project, const Paths& recordings,
                             std::optional<int> folds, std::optional<std::uint64_t> seed,
                             int threads, const std::string& zero_offsets, const Path& prior,
                             double days) {
  if (zero_offsets != "origin" && zero_offsets != "encoder") {
    throw InputError("zero_offsets: 'origin' or 'encoder' was expected");
  }
  if (threads < 1) throw InputError("threads: 1 or more were expected");
  if (!(days >= 0.0 && days < 1e5)) throw InputError("days: 0 or more were expected");
  PyCalibration calibration{project, {}, {}};
  calibration.run = CalibrateExperiment(
      project, recordings,
      {.folds = folds,
       .threads = threads,
       .zero_offsets = zero_offsets == "encoder" ? ZeroOffsets::kEncoder : ZeroOffsets::kOrigin,
       .seed = seed,
       .prior = prior,
       .days = days,
       .progress = StopOnSignals()});
  calibration.files = MakeCalibrationFiles(project, calibration.run);
  return calibration;
}

/// Only the files of the calibration: the record of runs and the page are the program's.
void Save(const PyCalibration& calibration, const Path& folder) {
  OutputSet outputs;
  for (const std::string& name : CalibrationFileNames(calibration.project)) {
    outputs.Declare(folder / name);
  }
  outputs.Prepare();
  for (const auto& [name, text] : calibration.files) outputs.Set(folder / name, text);
  outputs.Publish();
}

std::vector<std::string> ParameterNames(const PyCalibration& calibration) {
  std::vector<std::string> names;
  for (const Parameter& parameter : calibration.result().model.parameters) {
    names.push_back(parameter.name);
  }
  return names;
}

py::dict Compare(const Path& a, const Path& b, double level) {
  if (!(level > 0.0 && level < 1.0)) throw InputError("level: above 0, below 1 was expected");
  std::optional<ComparisonRun> run;
  {
    const py::gil_scoped_release unlocked;
    run = CompareCalibrations(a, b, {.level = level});
  }
  const CalibrationComparison& found = run->comparison;
  py::list moved, parameters;
  for (const JointDifference& joint : found.joints) {
    if (joint.moved) moved.append(joint.joint);
  }
  for (const ParameterDifference& one : found.parameters) {
    using namespace py::literals;
    parameters.append(py::dict("name"_a = one.name, "joint"_a = one.joint, "unit"_a = one.unit,
                               "a"_a = one.a, "b"_a = one.b, "difference"_a = one.difference,
                               "sd"_a = one.sd, "p"_a = one.p));
  }
  py::dict result;
  result["changed"] = found.changed;
  result["moved"] = moved;
  result["suspects"] = found.suspects;
  result["parameters"] = parameters;
  result["warnings"] = found.warnings;
  return result;
}

py::dict ToDict(const MarkerTrajectories& markers, const RecordingFile& file) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto frames = static_cast<py::ssize_t>(markers.frame_count());
  const auto count = static_cast<py::ssize_t>(markers.marker_count());
  py::array_t<double> positions({frames, count, py::ssize_t{3}});
  Eigen::Map<RowMajor>(positions.mutable_data(), frames, 3 * count) = markers.positions;
  py::dict result;
  result["names"] = markers.names;
  result["rate_hz"] = markers.rate_hz;
  result["positions"] = positions;
  result["up"] = file.up.empty() ? py::object(py::none()) : py::object(py::str(file.up));
  return result;
}

/// What the file holds, under its own names.
py::dict Read(const Path& path, const std::string& unit, const std::string& topic) {
  RecordingFile file;
  {
    const py::gil_scoped_release unlocked;
    file = ReadAnyRecording(path, {.unit = unit, .joints_topic = topic});
  }
  py::dict result;
  result["format"] = file.format;
  result["markers"] = py::none();
  result["joints"] = py::none();
  if (file.markers) result["markers"] = ToDict(*file.markers, file);
  if (file.joints) {
    py::dict joints;
    joints["names"] = file.joints->names;
    joints["time_s"] = std::move(file.joints->time_s);
    joints["positions"] = std::move(file.joints->positions);
    joints["torques"] = std::move(file.joints->torques);
    result["joints"] = joints;
  }
  result["notes"] = file.notes;
  return result;
}

/// A calibrated robot for a controller. An object serves one thread at a time.
class PyRuntime {
 public:
  PyRuntime(const Path& calibration, const Path& project, const std::string& content)
      : compensator_(Make(calibration, project, content)) {}

  const RuntimeModel& model() const { return compensator_.model(); }

  py::dict Forward(const Eigen::VectorXd& q, const Eigen::VectorXd& torque, StandingFeet feet) {
    const CompensatorStatus status = compensator_.Forward(q, Checked(q, torque), feet);
    py::dict poses;
    for (std::size_t i = 0; i < model().link_names.size(); ++i) {
      poses[py::str(model().link_names[i])] =
          Eigen::Matrix4d(compensator_.link_pose(static_cast<int>(i)).matrix());
    }
    py::dict result;
    result["links"] = poses;
    result["root"] = Eigen::Matrix4d(compensator_.root_pose().matrix());
    result["status"] = DescribeStatus(status);
    return result;
  }

  Eigen::VectorXd Command(const Eigen::VectorXd& q, const Eigen::VectorXd& torque,
                          StandingFeet feet) {
    compensator_.Command(q, Checked(q, torque), feet);
    return compensator_.command();
  }

  Eigen::VectorXd Correct(const Eigen::VectorXd& q, const Eigen::VectorXd& torque,
                          StandingFeet feet) {
    compensator_.Correct(q, Checked(q, torque), feet);
    return compensator_.rigid_positions();
  }

 private:
  static RuntimeModel Make(const Path& calibration, const Path& project,
                           const std::string& content) {
    const std::map<std::string, RuntimeContent> contents = {
        {"nominal", RuntimeContent::kNominal},
        {"geometry", RuntimeContent::kGeometry},
        {"everything", RuntimeContent::kEverything}};
    const auto found = contents.find(content);
    if (found == contents.end()) {
      throw InputError("content: 'nominal', 'geometry' or 'everything' was expected");
    }
    const CalibratedRobot robot = OpenCalibratedRobot(calibration, project);
    return MakeRuntimeModel(robot.project, robot.calibration, found->second);
  }

  const Eigen::VectorXd& Checked(const Eigen::VectorXd& q, const Eigen::VectorXd& torque) const {
    if (q.size() != model().coordinate_count()) {
      throw InputError("q: " + std::to_string(q.size()) + " positions; " +
                       std::to_string(model().coordinate_count()) + " were expected");
    }
    if (torque.size() != 0 && torque.size() != model().joint_count()) {
      throw InputError("torque: " + std::to_string(torque.size()) + " torques; none or " +
                       std::to_string(model().joint_count()) + " were expected");
    }
    return torque;
  }

  Compensator compensator_;
};

std::vector<std::string> JointNames(const Project& project) {
  std::vector<std::string> names;
  for (int joint : project.tree.coordinate_joint) names.push_back(project.tree.joints[joint].name);
  return names;
}

}  // namespace
}  // namespace elastocal

PYBIND11_MODULE(elastocal, module) {
  using namespace elastocal;
  using py::literals::operator""_a;
  using Unlocked = py::call_guard<py::gil_scoped_release>;
  module.doc() = "Elasto-geometric calibration of robots. SI units and radians everywhere.";
  module.attr("__version__") = ProgramVersion();
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError);

  py::class_<Project>(module, "Project", "A project file with its robot.")
      .def(py::init([](const Path& file) { return ReadProject(file); }), "file"_a, Unlocked())
      .def_property_readonly("robot", [](const Project& p) { return p.tree.name; })
      .def_property_readonly("file", [](const Project& p) { return p.file.string(); })
      .def_property_readonly("urdf", [](const Project& p) { return p.urdf.string(); })
      .def_property_readonly("joints", JointNames, "Joints that are entries of q, in its order.")
      .def_property_readonly("chains",
                             [](const Project& p) {
                               std::vector<std::string> names;
                               for (const Chain& chain : p.chains) names.push_back(chain.name);
                               return names;
                             })
      .def_property_readonly("markers", [](const Project& p) {
        std::vector<std::string> names;
        for (const Marker& marker : p.markers) names.push_back(marker.name);
        return names;
      });

  py::class_<PyCalibration>(module, "Calibration", "What calibrate() found.")
      .def_property_readonly("deployable",
                             [](const PyCalibration& c) { return c.run.deployable(); })
      .def_property_readonly("status", [](const PyCalibration& c) { return RunStatus(c.run); })
      .def_property_readonly("objections",
                             [](const PyCalibration& c) { return c.run.verdict.objections; })
      .def_property_readonly("warnings", [](const PyCalibration& c) { return c.run.warnings; })
      .def_property_readonly("urdf_rmse_mm",
                             [](const PyCalibration& c) {
                               const int kind = static_cast<int>(c.run.deployment.urdf_kind);
                               return 1e3 * c.run.comparison.metrics[kind].rmse_3d;
                             })
      .def_property_readonly("parameters", ParameterNames)
      .def_property_readonly(
          "values", [](const PyCalibration& c) { return c.result().delta; },
          "Errors, one a parameter, rad, m and their ratios.")
      .def_property_readonly(
          "sd", [](const PyCalibration& c) { return c.result().sd; },
          "Standard deviations, one a parameter; NaN where none applies.")
      .def_property_readonly(
          "summary", [](const PyCalibration& c) { return FromJson(c.files.at("summary.json")); })
      .def_property_readonly(
          "files", [](const PyCalibration& c) { return c.files; },
          "Texts of the files that `elastocal calibrate` writes, by name.")
      .def("save", Save, "folder"_a, "Writes these files.", Unlocked());

  module.def("calibrate", CalibrateFiles, "project"_a, "recordings"_a, py::kw_only(),
             "folds"_a = std::nullopt, "seed"_a = std::nullopt, "threads"_a = 1,
             "zero_offsets"_a = "origin", "prior"_a = "", "days"_a = 1.0, Unlocked(),
             "Calibrates from posture tables or recording folders, like the command of that name.");
  module.def(
      "validate",
      [](const Project& project, const Path& calibration, const Path& recording, bool frozen) {
        std::string json;
        {
          const py::gil_scoped_release unlocked;
          json = MakeValidationJson(
              ValidateCalibration(project, calibration, recording, {.frozen = frozen}));
        }
        return FromJson(json);
      },
      "project"_a, "calibration"_a, "recording"_a, py::kw_only(), "frozen"_a = false,
      "Applies a saved calibration to another recording: what validation.json has, as a dict.");
  module.def(
      "check",
      [](const Project& project, const Path& calibration, const Path& recording, double level,
         double days) {
        if (!(level > 0.0 && level < 1.0)) throw InputError("level: above 0, below 1 was expected");
        if (!(days >= 0.0 && days < 1e5)) throw InputError("days: 0 or more were expected");
        std::string json;
        {
          const py::gil_scoped_release unlocked;
          json = MakeCheckJson(CheckCalibration(project, calibration, recording,
                                                {.joints = {.level = level}, .days = days}));
        }
        return FromJson(json);
      },
      "project"_a, "calibration"_a, "recording"_a, py::kw_only(), "level"_a = 0.05, "days"_a = 1.0,
      "Tells from a few postures whether a saved calibration still holds: what `elastocal check` "
      "writes with --json, as a dict.");
  module.def("compare", Compare, "a"_a, "b"_a, py::kw_only(), "level"_a = 0.05,
             "Tells which joints moved between two saved calibrations.");
  module.def("read", Read, "file"_a, py::kw_only(), "unit"_a = "", "topic"_a = "",
             "Reads a recording of any format: 'markers' with positions (frames, markers, 3) in m, "
             "NaN where not seen, and 'joints' with time_s (samples), positions and torques "
             "(samples, joints).");
  module.def(
      "info",
      [](const Path& file, const std::string& unit, const std::string& topic) {
        std::string json;
        {
          const py::gil_scoped_release unlocked;
          json = MakeInfoJson(
              DescribeRecording(file.string(), {.unit = unit, .joints_topic = topic}, 48));
        }
        return FromJson(json);
      },
      "file"_a, py::kw_only(), "unit"_a = "", "topic"_a = "",
      "What `elastocal info --json` has, as a dict.");

  py::class_<PyRuntime>(module, "Runtime", "The calibrated robot in a controller.")
      .def(py::init<const Path&, const Path&, const std::string&>(), "calibration"_a,
           "project"_a = Path(), "content"_a = "everything", Unlocked())
      .def_property_readonly("joints",
                             [](const PyRuntime& r) { return r.model().coordinate_names; })
      .def_property_readonly("links", [](const PyRuntime& r) { return r.model().link_names; })
      .def_property_readonly("feet", [](const PyRuntime& r) { return r.model().foot_names; })
      .def("forward", &PyRuntime::Forward, "q"_a, "torque"_a = Eigen::VectorXd(), "feet"_a = 0u,
           "Poses (4, 4) of all links in the root link's frame, with deflection; q: (joints,). "
           "feet: bit i for foot i that stands.")
      .def("command", &PyRuntime::Command, "q"_a, "torque"_a = Eigen::VectorXd(), "feet"_a = 0u,
           "Positions to command so that hands and feet go where the nominal robot has them at q.")
      .def(
          "correct", &PyRuntime::Correct, "q"_a, "torque"_a = Eigen::VectorXd(), "feet"_a = 0u,
          "Positions at which a rigid calibrated robot has its hands where the real one has them.");
}
