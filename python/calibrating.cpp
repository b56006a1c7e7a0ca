// SPDX-License-Identifier: Apache-2.0
#include "bindings.hpp"
#include "elastocal/elastocal.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/contact_check.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/contact_validation.hpp"
#include "elastocal/planning/next_postures.hpp"
#include "elastocal/report/version.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal::python {
namespace {

/// Checks an argument for projects with contact or instruments.
void Expect(bool usual, const char* argument, const std::string& why) {
  if (usual) return;
  throw InputError(std::string(argument) + ": not with contact or instruments: " + why);
}

/// Raises TypeError like Python for a missing argument.
Paths RecordingsOf(const py::object& recordings, const std::string& argument) {
  if (!recordings.is_none()) return PathsOf(recordings);
  throw py::type_error("missing argument '" + argument +
                       "': the file or folder of a recording, or a list of them, was expected");
}

/// A calibration from markers, or from touches and instruments, that was made in this process.
struct PyCalibration {
  Project project;
  bool deployable;
  std::string status;
  Names objections, warnings;
  double urdf_rmse;      ///< m, in the fit; NaN without markers
  double held_out_rmse;  ///< m, of the same URDF; NaN if nothing was held out
  CalibrationResult result;
  std::map<std::string, std::string> files;
  RunRecord record = {};                ///< for runs.json; `command_line` is made when saved
  std::vector<std::string> words = {};  ///< command line with the same result
};

/// The arguments of calibrate().
struct CalibrateArguments {
  std::optional<int> folds;
  std::string fold_by;
  std::optional<std::uint64_t> seed;
  int threads;
  ZeroOffsets zero_offsets;
  Path prior;
  double days;
  Path marker_places;
  Names accept;
  StepProgress progress;
};

/// The command line with the same result, without its output.
std::vector<std::string> CommandWords(const Project& project, const Paths& files,
                                      const CalibrateArguments& given) {
  std::vector<std::string> words = {"elastocal", "calibrate", project.file.string(), "--recording"};
  for (const Path& file : files) words.push_back(file.string());
  const auto add = [&](const char* option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  if (given.folds) add("--kfold", std::to_string(*given.folds));
  if (given.fold_by != "posture") add("--fold-by", given.fold_by);
  if (given.seed) add("--seed", std::to_string(*given.seed));
  if (given.zero_offsets == ZeroOffsets::kEncoder) add("--zero-offsets", "encoder");
  if (!given.prior.empty()) {
    add("--prior", given.prior.string());
    add("--days", FormatNumber(given.days));
  }
  if (!given.marker_places.empty()) add("--marker-places", given.marker_places.string());
  for (const std::string& mistake : given.accept) add("--accept", mistake);
  return words;
}

RunRecord RecordOf(const Project& project, const Paths& files, const CalibrateArguments& given) {
  Paths inputs = InputFiles(project, files);
  if (!given.prior.empty()) {
    const CalibrationFiles earlier = FindCalibrationFiles(given.prior);
    inputs.insert(inputs.end(), {earlier.calibration, earlier.covariance});
  }
  if (!given.marker_places.empty()) inputs.push_back(given.marker_places);
  std::error_code unknown;  // for a folder that was removed
  return {.command = "calibrate",
          .command_line = {},
          .version = ProgramVersion(),
          .seed = given.seed,
          .inputs = RecordInputs(inputs),
          .folder = std::filesystem::current_path(unknown).string(),
          .assumptions = Assumptions{given.accept, given.prior.string(), given.days,
                                     given.marker_places.string()}};
}

PyCalibration CalibrateMarkers(const Project& project, const Paths& files,
                               const CalibrateArguments& given) {
  CalibrationRun run =
      CalibrateExperiment(project, files,
                          {.folds = given.folds,
                           .fold_unit = Named<FoldUnit>("fold_by", given.fold_by,
                                                        {{"posture", FoldUnit::kPosture},
                                                         {"trial", FoldUnit::kTrial},
                                                         {"session", FoldUnit::kSession}}),
                           .threads = given.threads,
                           .zero_offsets = given.zero_offsets,
                           .seed = given.seed,
                           .accept = given.accept,
                           .prior = given.prior,
                           .days = given.days,
                           .marker_places = given.marker_places,
                           .progress = given.progress});
  auto texts = MakeCalibrationFiles(project, run);
  const bool judged_on_fit = run.deployment.judged_on == "the fit";
  const int in_urdf = static_cast<int>(run.deployment.urdf_kind);
  return {project,
          run.deployable(),
          RunStatus(run),
          run.verdict.objections,
          run.warnings,
          run.comparison.metrics[in_urdf].rmse_3d,
          judged_on_fit ? kNaN : run.deployment.urdf,
          run.comparison.largest(),
          std::move(texts)};
}

PyCalibration CalibrateInstruments(const Project& project, const Paths& files,
                                   const CalibrateArguments& given) {
  Expect(given.fold_by == "posture", "fold_by", "a fold leaves out postures");
  Expect(given.marker_places.empty(), "marker_places",
         "mounting_sd_mm of an instrument says how well its place is known");
  ContactRunOptions options{.folds = given.folds,
                            .threads = given.threads,
                            .zero_offsets = given.zero_offsets,
                            .accept = given.accept,
                            .prior = given.prior,
                            .days = given.days};
  if (given.progress) {
    options.progress = [&](int done, int total) {
      given.progress("cross-validation", done, total);
    };
  }
  ContactRun run = CalibrateContacts(project, files, options);
  auto texts = MakeContactFiles(project, run);
  return {project, run.deployable(), RunStatus(run),  run.verdict.objections, run.warnings, kNaN,
          kNaN,    run.result,       std::move(texts)};
}

PyCalibration CalibrateFiles(const ProjectOrFile& project_or_file, const py::object& recordings,
                             std::optional<int> folds, const std::string& fold_by,
                             std::optional<std::uint64_t> seed, int threads,
                             const std::string& zero_offsets, const Path& prior,
                             std::optional<double> days, const Path& marker_places,
                             const Names& accept, const StepProgress& progress) {
  const Project& project = project_or_file.project;
  ExpectWithin("threads", threads, 1, 64);
  if (folds) ExpectWithin("folds", *folds, 0, 100000);
  if (days) {
    ExpectBounded("calibrate --days", *days);
    if (prior.empty()) throw InputError("days: without the earlier calibration, prior");
  }
  const Paths files = RecordingsOf(recordings, "recordings");
  const CalibrateArguments given{
      folds,
      fold_by,
      seed,
      threads,
      Named<ZeroOffsets>("zero_offsets", zero_offsets,
                         {{"origin", ZeroOffsets::kOrigin}, {"encoder", ZeroOffsets::kEncoder}}),
      prior,
      days.value_or(1.0),
      marker_places,
      accept,
      progress};
  return Unlocked([&] {
    PyCalibration found = project.contact ? CalibrateInstruments(project, files, given)
                                          : CalibrateMarkers(project, files, given);
    found.record = RecordOf(project, files, given);
    found.words = CommandWords(project, files, given);
    return found;
  });
}

/// Writes the files of `elastocal calibrate -o`.
void Save(const PyCalibration& calibration, const Path& folder) {
  RunRecord record = calibration.record;
  std::vector<std::string> words = calibration.words;
  words.insert(words.end(), {"-o", folder.string()});
  record.command_line = QuoteCommandLine(words);
  OutputSet outputs;
  Paths inputs;
  for (const InputRecord& input : record.inputs) inputs.emplace_back(input.file);
  outputs.Protect(inputs);
  DeclareResults(folder, CalibrationFileNames(calibration.project), outputs);
  outputs.Prepare();
  SetResults(folder, calibration.files, record, outputs);
  outputs.Publish();
}

Names ParameterNames(const PyCalibration& calibration) {
  Names names;
  for (const Parameter& parameter : calibration.result.model.parameters) {
    names.push_back(parameter.name);
  }
  return names;
}

void ExpectOneRecording(const Paths& files) {
  if (files.size() == 1) return;
  throw InputError("recording: " + std::to_string(files.size()) +
                   " files; one was expected, because the project has neither contact nor "
                   "instruments");
}

py::object Validate(const ProjectOrFile& project_or_file, const Path& calibration,
                    const py::object& recording, bool frozen,
                    const std::optional<std::string>& refit, std::optional<std::uint64_t> seed,
                    const Names& accept) {
  const Project& project = project_or_file.project;
  const Paths files = RecordingsOf(recording, "recording");
  const bool refit_table = refit && Named<bool>("refit", *refit, {{"table", true}});
  if (project.contact) {
    Expect(!frozen, "frozen", "it is about markers; touches have refit='table'");
    return FromJson(Unlocked([&] {
      return MakeContactValidationJson(
          ValidateContacts(project, calibration, files, refit_table, accept));
    }));
  }
  if (refit_table) throw InputError("refit: 'table' is about touches of a table");
  ExpectOneRecording(files);
  return FromJson(Unlocked([&] {
    return MakeValidationJson(ValidateCalibration(
        project, calibration, files.front(), {.frozen = frozen, .seed = seed, .accept = accept}));
  }));
}

py::object Check(const ProjectOrFile& project_or_file, const Path& calibration,
                 const py::object& recording, double level, double days,
                 std::optional<std::uint64_t> seed, const Names& accept, bool new_markers) {
  const Project& project = project_or_file.project;
  const Paths files = RecordingsOf(recording, "recording");
  ExpectBounded("check --level", level);
  ExpectBounded("check --days", days);
  const CheckOptions options{.joints = {.level = level, .new_markers = new_markers},
                             .days = days,
                             .seed = seed,
                             .accept = accept};
  if (project.contact) {
    return FromJson(Unlocked([&] {
      const ContactCheck run = CheckContacts(project, calibration, files, options);
      return MakeCheckJson(project, run, DesignNextPostures(project, calibration, run, options));
    }));
  }
  ExpectOneRecording(files);
  return FromJson(Unlocked([&] {
    const CheckRun run = CheckCalibration(project, calibration, files.front(), options);
    return MakeCheckJson(project, run, DesignNextPostures(project, calibration, run, options));
  }));
}

py::dict Compare(const Path& a, const Path& b, double level, bool new_markers) {
  ExpectBounded("compare --level", level);
  const ComparisonRun run = Unlocked(
      [&] { return CompareCalibrations(a, b, {.level = level, .new_markers = new_markers}); });
  const CalibrationComparison& found = run.comparison;
  py::list moved, parameters, markers, soles;
  py::dict or_markers;
  for (const JointDifference& joint : found.joints) {
    if (!joint.moved) continue;
    moved.append(joint.joint);
    or_markers[py::str(joint.joint)] = joint.or_markers;
  }
  for (const LinkMarkers& link : found.markers) {
    markers.append(py::dict("link"_a = link.link, "markers"_a = link.markers, "same"_a = link.same,
                            "p"_a = link.p, "as_one_piece"_a = link.as_one_piece));
  }
  for (const ParameterDifference& one : found.parameters) {
    parameters.append(py::dict("name"_a = one.name, "joint"_a = one.joint, "unit"_a = one.unit,
                               "a"_a = one.a, "b"_a = one.b, "difference"_a = one.difference,
                               "sd"_a = one.sd, "p"_a = one.p));
  }
  for (const SoleDifference& one : run.soles) {
    soles.append(py::dict("leg"_a = one.leg, "a"_a = one.a, "b"_a = one.b,
                          "difference"_a = one.b - one.a, "sd"_a = one.sd,
                          "significant"_a = one.significant()));
  }
  py::dict result;
  result["changed"] = found.changed;
  result["moved"] = moved;
  result["or_markers"] = or_markers;
  result["markers"] = markers;
  result["suspects"] = found.suspects;
  result["parameters"] = parameters;
  result["soles"] = soles;
  result["warnings"] = found.warnings;
  return result;
}

void AddCalibrationClass(py::module_& module) {
  py::class_<PyCalibration>(module, "Calibration", "What calibrate() found.")
      .def_readonly("deployable", &PyCalibration::deployable,
                    "Whether the calibration can be trusted; if not, see `objections`.")
      .def_readonly("status", &PyCalibration::status,
                    "'converged', 'not converged', 'failed' or 'implausible'.")
      .def_readonly("objections", &PyCalibration::objections,
                    "Why it cannot be trusted, a sentence each.")
      .def_readonly("warnings", &PyCalibration::warnings,
                    "What a user should know, a sentence each.")
      .def_property_readonly(
          "urdf_rmse_mm", [](const PyCalibration& c) { return 1e3 * c.urdf_rmse; },
          "Root mean square of the markers' distances to what the calibrated URDF alone predicts, "
          "on the recording that it was fitted to; NaN of a project with contact or instruments "
          "(its errors: summary['contact']).")
      .def_property_readonly(
          "held_out_rmse_mm", [](const PyCalibration& c) { return 1e3 * c.held_out_rmse; },
          "The same on trials or postures that were not used for the fit, the first figure that "
          "the program prints; NaN where nothing was held out (folds=0), and where urdf_rmse_mm "
          "is.")
      .def_property_readonly("parameters", ParameterNames, "Names, in the order of `values`.")
      .def_property_readonly(
          "values", [](const PyCalibration& c) { return c.result.delta; },
          "Errors (parameters,), rad, m and their ratios.")
      .def_property_readonly(
          "sd", [](const PyCalibration& c) { return c.result.sd; },
          "Standard deviations (parameters,); NaN where none applies.")
      .def_property_readonly(
          "summary", [](const PyCalibration& c) { return FromJson(c.files.at("summary.json")); },
          "The dict of summary.json.")
      .def_property_readonly(
          "files", [](const PyCalibration& c) { return c.files; },
          "Texts of the files that `elastocal calibrate` writes, by name.")
      .def("save", Save, "folder"_a,
           "Writes these files, runs.json and the report, as `elastocal calibrate -o` does.",
           py::call_guard<LongCall>());
}

}  // namespace

void AddCalibrating(py::module_& module) {
  AddCalibrationClass(module);
  module.def(
      "calibrate", CalibrateFiles, "project"_a, "recordings"_a = py::none(), py::kw_only(),
      "folds"_a = std::nullopt, "fold_by"_a = "posture", "seed"_a = std::nullopt, "threads"_a = 1,
      "zero_offsets"_a = "origin", "prior"_a = "", "days"_a = std::nullopt, "marker_places"_a = "",
      "accept"_a = Names(), "progress"_a = StepProgress(),
      "Calibrates from a posture table or from recording folders (a path or several), like the "
      "command of that name; with contact or instruments, from tables of observations. folds: of "
      "the cross-validation, 0 for none; None: ten for a table. fold_by: what a fold leaves out, "
      "'posture', 'trial' or 'session'. prior: the folder of an earlier calibration, `days` ago "
      "(None: one). "
      "marker_places: a table of where markers are on their links, as measured there. "
      "accept: mistakes of the recording to undo. progress: called with (step, done, total).");
  module.def(
      "validate", Validate, "project"_a, "calibration"_a, "recording"_a = py::none(), py::kw_only(),
      "frozen"_a = false, "refit"_a = std::nullopt, "seed"_a = std::nullopt, "accept"_a = Names(),
      "Applies a saved calibration to another recording (with contact or instruments, tables of "
      "observations): the dict of validation.json. frozen: waist and markers are not fitted anew. "
      "refit: 'table' registers tables and trackers anew, for each posture by the others.");
  module.def(
      "check", Check, "project"_a, "calibration"_a, "recording"_a = py::none(), py::kw_only(),
      "level"_a = 0.05, "days"_a = 1.0, "seed"_a = std::nullopt, "accept"_a = Names(),
      "new_markers"_a = false,
      "Tells from a few postures (with contact or instruments, tables of observations) whether a "
      "saved calibration still holds: the dict of `elastocal check --json`, of markers with the "
      "'next_postures' to record where several joints may have changed. "
      "level: chance of a false alarm. days: since the calibration. new_markers: markers were "
      "taken off since.");
  module.def("compare", Compare, "a"_a, "b"_a, py::kw_only(), "level"_a = 0.05,
             "new_markers"_a = false,
             "Tells which joints moved between two saved calibrations: a dict with 'changed', "
             "'moved', 'or_markers' (by moved joint, links whose markers may have moved as one "
             "piece instead), 'suspects', 'markers' (by link, whether they are 'same'), 'soles' "
             "(springs, m/N), 'warnings' "
             "and 'parameters' (values in SI units). new_markers: markers were taken off in "
             "between.");
}

}  // namespace elastocal::python
