// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"
#include "elastocal/elastocal.hpp"
#include "elastocal/planning/next_postures.hpp"

namespace elastocal::python {
namespace {

/// A calibration that was made in this process.
struct PyCalibration {
  Project project;
  CalibrationRun run;
  std::map<std::string, std::string> files;

  const CalibrationResult& result() const { return run.comparison.largest(); }
};

void RefuseInstruments(const Project& project) {
  if (!project.contact) return;
  throw InputError(project.file.string() +
                   ": a project with contact or instruments is calibrated by the program "
                   "(elastocal calibrate); here, one with markers was expected");
}

PyCalibration CalibrateFiles(const Project& project, const py::object& recordings,
                             std::optional<int> folds, const std::string& fold_by,
                             std::optional<std::uint64_t> seed, int threads,
                             const std::string& zero_offsets, const Path& prior, double days,
                             const Names& accept, const StepProgress& progress) {
  RefuseInstruments(project);
  ExpectWithin("threads", threads, 1, 64);
  ExpectBounded("calibrate --days", days);
  const Paths files = PathsOf(recordings);
  const ExperimentOptions options{
      .folds = folds,
      .fold_unit = Named<FoldUnit>("fold_by", fold_by,
                                   {{"posture", FoldUnit::kPosture}, {"trial", FoldUnit::kTrial}}),
      .threads = threads,
      .zero_offsets = Named<ZeroOffsets>(
          "zero_offsets", zero_offsets,
          {{"origin", ZeroOffsets::kOrigin}, {"encoder", ZeroOffsets::kEncoder}}),
      .seed = seed,
      .accept = accept,
      .prior = prior,
      .days = days,
      .progress = progress};
  return Unlocked([&] {
    PyCalibration calibration{project, CalibrateExperiment(project, files, options), {}};
    calibration.files = MakeCalibrationFiles(project, calibration.run);
    return calibration;
  });
}

/// Only the files of the calibration: the record of runs and the page are the program's.
void Save(const PyCalibration& calibration, const Path& folder) {
  OutputSet outputs;
  outputs.Protect({calibration.project.file, calibration.project.urdf});
  for (const std::string& name : CalibrationFileNames(calibration.project)) {
    outputs.Declare(folder / name);
  }
  outputs.Prepare();
  for (const auto& [name, text] : calibration.files) outputs.Set(folder / name, text);
  outputs.Publish();
}

Names ParameterNames(const PyCalibration& calibration) {
  Names names;
  for (const Parameter& parameter : calibration.result().model.parameters) {
    names.push_back(parameter.name);
  }
  return names;
}

py::object Validate(const Project& project, const Path& calibration, const Path& recording,
                    bool frozen, std::optional<std::uint64_t> seed, const Names& accept) {
  RefuseInstruments(project);
  return FromJson(Unlocked([&] {
    return MakeValidationJson(ValidateCalibration(
        project, calibration, recording, {.frozen = frozen, .seed = seed, .accept = accept}));
  }));
}

py::object Check(const Project& project, const Path& calibration, const Path& recording,
                 double level, double days, std::optional<std::uint64_t> seed,
                 const Names& accept) {
  RefuseInstruments(project);
  ExpectBounded("check --level", level);
  ExpectBounded("check --days", days);
  const CheckOptions options{
      .joints = {.level = level}, .days = days, .seed = seed, .accept = accept};
  return FromJson(Unlocked([&] {
    const CheckRun run = CheckCalibration(project, calibration, recording, options);
    return MakeCheckJson(project, run, DesignNextPostures(project, calibration, run, options));
  }));
}

py::dict Compare(const Path& a, const Path& b, double level) {
  ExpectBounded("compare --level", level);
  const ComparisonRun run = Unlocked([&] { return CompareCalibrations(a, b, {.level = level}); });
  const CalibrationComparison& found = run.comparison;
  py::list moved, parameters;
  for (const JointDifference& joint : found.joints) {
    if (joint.moved) moved.append(joint.joint);
  }
  for (const ParameterDifference& one : found.parameters) {
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

void AddCalibrationClass(py::module_& module) {
  py::class_<PyCalibration>(module, "Calibration", "What calibrate() found.")
      .def_property_readonly(
          "deployable", [](const PyCalibration& c) { return c.run.deployable(); },
          "Whether the calibration can be trusted; if not, see `objections`.")
      .def_property_readonly(
          "status", [](const PyCalibration& c) { return RunStatus(c.run); },
          "'converged', 'not converged', 'failed' or 'implausible'.")
      .def_property_readonly(
          "objections", [](const PyCalibration& c) { return c.run.verdict.objections; },
          "Why it cannot be trusted, a sentence each.")
      .def_property_readonly(
          "warnings", [](const PyCalibration& c) { return c.run.warnings; },
          "What a user should know, a sentence each.")
      .def_property_readonly(
          "urdf_rmse_mm",
          [](const PyCalibration& c) {
            const int kind = static_cast<int>(c.run.deployment.urdf_kind);
            return 1e3 * c.run.comparison.metrics[kind].rmse_3d;
          },
          "Root mean square of the markers' distances to what the calibrated URDF alone predicts.")
      .def_property_readonly("parameters", ParameterNames, "Names, in the order of `values`.")
      .def_property_readonly(
          "values", [](const PyCalibration& c) { return c.result().delta; },
          "Errors (parameters,), rad, m and their ratios.")
      .def_property_readonly(
          "sd", [](const PyCalibration& c) { return c.result().sd; },
          "Standard deviations (parameters,); NaN where none applies.")
      .def_property_readonly(
          "summary", [](const PyCalibration& c) { return FromJson(c.files.at("summary.json")); },
          "The dict of summary.json.")
      .def_property_readonly(
          "files", [](const PyCalibration& c) { return c.files; },
          "Texts of the files that `elastocal calibrate` writes, by name.")
      .def("save", Save, "folder"_a, "Writes these files.", py::call_guard<LongCall>());
}

}  // namespace

void AddCalibrating(py::module_& module) {
  AddCalibrationClass(module);
  module.def(
      "calibrate", CalibrateFiles, "project"_a, "recordings"_a, py::kw_only(),
      "folds"_a = std::nullopt, "fold_by"_a = "posture", "seed"_a = std::nullopt, "threads"_a = 1,
      "zero_offsets"_a = "origin", "prior"_a = "", "days"_a = 1.0, "accept"_a = Names(),
      "progress"_a = StepProgress(),
      "Calibrates from a posture table or from recording folders (a path or several), like the "
      "command of that name. folds: of the cross-validation, 0 for none; None: ten for a table. "
      "prior: the folder of an earlier calibration, `days` ago. accept: mistakes of the recording "
      "to undo. progress: called with (step, done, total).");
  module.def(
      "validate", Validate, "project"_a, "calibration"_a, "recording"_a, py::kw_only(),
      "frozen"_a = false, "seed"_a = std::nullopt, "accept"_a = Names(),
      "Applies a saved calibration to another recording: the dict of validation.json. frozen: "
      "waist and markers are not fitted anew.");
  module.def(
      "check", Check, "project"_a, "calibration"_a, "recording"_a, py::kw_only(), "level"_a = 0.05,
      "days"_a = 1.0, "seed"_a = std::nullopt, "accept"_a = Names(),
      "Tells from a few postures whether a saved calibration still holds: the dict of `elastocal "
      "check --json`, with the 'next_postures' to record where several joints may have changed. "
      "level: chance of a false alarm. days: since the calibration.");
  module.def("compare", Compare, "a"_a, "b"_a, py::kw_only(), "level"_a = 0.05,
             "Tells which joints moved between two saved calibrations: a dict with 'changed', "
             "'moved', 'suspects', 'warnings' and 'parameters' (values in SI units).");
}

}  // namespace elastocal::python
