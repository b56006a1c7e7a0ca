// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/validate_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/mistakes/read_accepting.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/transfer_faults.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/pipeline/known_places.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/validation/deployment.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

bool HasConverged(const Refit& refit) {
  return refit.result.termination == Termination::kConverged;
}

/// Root mean square error of the markers on the calibrated robot, outliers included, m.
double ErrorOf(const TransferValidation& transfer) {
  return transfer.calibrated.metrics_all.rmse_3d;
}

void CheckWaist(const ValidationRun& run, const Recording& recording) {
  if (!run.frozen || HasPoseByPosture(recording) || run.calibration.T_ref_waist) return;
  throw InputError(run.calibration_file +
                   ": no key 'waist': made from trials, it says nothing of the "
                   "waist in a table of postures; validate it without frozen");
}

TransferValidation TransferTo(const Recording& recording, const RecordedModel& robot,
                              const Project& project, const ValidationRun& run) {
  const StoredCalibration& stored = run.calibration;
  if (!run.frozen) {
    return ValidateTransfer(robot.model, recording, robot.base, project.calibration,
                            stored.joint_errors);
  }
  return ValidateFrozen(robot.model, recording, project.calibration,
                        {.T_ref_waist = stored.T_ref_waist,
                         .joint_errors = stored.joint_errors,
                         .externals = stored.externals,
                         .uncalibrated_externals = stored.uncalibrated_externals});
}

/// Error of the calibrated robot only.
double ErrorOn(const Recording& recording, const RecordedModel& robot, const Project& project,
               const ValidationRun& run) {
  if (run.frozen) return ErrorOf(TransferTo(recording, robot, project, run));
  return RefitTo(robot.model, recording, robot.base, project.calibration,
                 run.calibration.joint_errors)
      .metrics_all.rmse_3d;
}

/// Makes measured marker positions prior knowledge, as they are stated. The joints are not fitted,
/// so that a contradiction may be due to the calibration.
std::vector<MarkerMeasurement> KnowPlaces(const std::filesystem::path& file,
                                          const RecordedModel& robot, const Recording& recording,
                                          Project& project, ValidationRun& run) {
  if (file.empty()) return {};
  if (run.frozen) {
    throw InputError(file.string() +
                     ": measured places of markers (--marker-places) and --frozen: nothing is "
                     "fitted beside them");
  }
  std::vector<MarkerMeasurement> places =
      OpenMarkerPlaces(file, project, recording, robot.knocks, run.warnings);
  KnowMarkers(places, robot.model, project.calibration.earlier);
  return places;
}

/// Compares the refitted markers with their measured positions, and names those that are further
/// off than chance allows.
void CompareWithPlaces(const std::vector<MarkerMeasurement>& places, double probability,
                       ValidationRun& run) {
  if (places.empty()) return;
  const CalibrationResult& refit = run.transfer.calibrated.result;
  run.places = PlaceResiduals(places, refit);
  const double most = ChiSquareQuantile(
      1.0 - probability / static_cast<double>(std::max<std::size_t>(1, run.places.size())), 3.0);
  for (const PlaceResidual& place : run.places) {
    if (place.squares <= most) continue;
    run.warnings.push_back(fmt::format(
        "marker {} is {:.2g} mm from its measured place ({:.1f} standard deviations where 1 is "
        "expected): the calibration has the frame of its link elsewhere, or the place is wrong",
        place.marker, 1e3 * place.distance, place.in_sds()));
  }
}

/// The errors for which a URDF has a place: without compliances and corrections, also where its
/// geometry is that of the full model.
std::map<std::string, double> GeometryInUrdf(const StoredCalibration& stored,
                                             const ErrorModel& model) {
  std::map<std::string, double> errors = AsInUrdf(stored).joint_errors;
  for (const Parameter& parameter : model.parameters) {
    if (IsElastic(parameter.kind)) errors.erase(parameter.name);
  }
  return errors;
}

/// Warns where more than one in twenty observations is an outlier.
void WarnOfOutliers(ValidationRun& run) {
  const auto outliers = run.transfer.calibrated.result.outliers.size();
  const auto seen = SeenMask(run.recording).count();
  if (20 * static_cast<Eigen::Index>(outliers) <= seen) return;
  run.warnings.push_back(std::to_string(outliers) + " of " + std::to_string(seen) +
                         " observations are outliers of the calibrated model; see the figures "
                         "with outliers");
}

/// Error of the calibrated robot expected on other recordings, by its file, m.
double ExpectedOf(const StoredCalibration& stored) {
  return std::max(stored.rmse_3d, stored.held_out.compensated);
}

/// Names faults of the recording that contradict the joints as calibrated, after waist and markers
/// are fitted.
void NameFaults(const Project& project, std::optional<std::uint64_t> seed,
                const Measurements& as_recorded, const RecordedModel& robot,
                const Measurements& measured, ValidationRun& run) {
  const double expected = ExpectedOf(run.calibration);
  if (expected == 0.0) return;
  std::optional<TransferValidation> refitted;
  if (run.frozen) {
    if (!(ErrorOf(run.transfer) > kWorseThanPredicted * expected)) return;
    try {
      refitted = ValidateTransfer(robot.model, measured.calibration, robot.base,
                                  project.calibration, run.calibration.joint_errors);
    } catch (const InputError&) {
      return;  // too few postures to fit waist and markers by
    }
  }
  const auto holds = [&](Measurements corrected) {
    const RecordedModel plain = MakeRecordedModel(project, seed, corrected, KnockSearch::kNone);
    return ErrorOn(corrected.calibration, plain, project, run) <= kWorseThanPredicted * expected;
  };
  run.mistakes = FindTransferFaults({.project = project,
                                     .robot = robot,
                                     .as_recorded = as_recorded,
                                     .recording = measured.calibration,
                                     .transfer = refitted ? *refitted : run.transfer,
                                     .joint_errors = run.calibration.joint_errors,
                                     .expected = expected,
                                     .holds = holds});
}

/// Moves the warnings about judged trials that cannot be used to `not_judged`.
void NameUnused(const std::vector<TrialSummary>& trials, ValidationRun& run) {
  const bool by_calibration = std::ranges::any_of(run.recording.trials, [](const Trial& trial) {
    return trial.kind == TrialKind::kCalibration;
  });
  for (const TrialSummary& trial : trials) {
    const bool judged = (trial.trial.kind == TrialKind::kCalibration) == by_calibration;
    if (trial.refused.empty() || !judged) continue;
    std::erase(run.warnings, "trial " + trial.trial.name + ": not used: " + trial.refused);
    run.not_judged.push_back(fmt::format(
        "trial {} is not judged ({}): record it again or, to judge the others, take it out of "
        "experiment.yaml",
        trial.trial.name, trial.refused));
  }
}

/// Warns where the calibration was made from this recording, or predicted a smaller error than it
/// shows.
void CompareWithPrediction(const Project& project, const std::filesystem::path& recording,
                           ValidationRun& run) {
  const HeldOutErrors& held_out = run.calibration.held_out;
  run.predicted = run.urdf ? held_out.urdf : held_out.compensated;
  run.shown = (run.urdf ? *run.urdf : run.transfer.calibrated).metrics_all.rmse_3d;
  run.own_recording =
      WarnOfOwnRecording(run.calibration_file, InputFiles(project, {recording}), run.warnings);
  if (!run.own_recording && !run.as_predicted() && run.better() && !run.urdf_worse()) {
    run.warnings.push_back(fmt::format(
        "the {} errs by {:.2g} mm, where its calibration predicted {:.2g} mm: the robot has "
        "changed, or moves where it was not calibrated; `elastocal check` says whether a joint "
        "moved",
        run.urdf ? "calibrated URDF" : "calibrated robot", 1e3 * run.shown, 1e3 * run.predicted));
  }
}

}  // namespace

bool ValidationRun::converged() const {
  return HasConverged(transfer.calibrated) && HasConverged(transfer.uncalibrated);
}

bool ValidationRun::better() const {
  return transfer.calibrated.metrics_all.rmse_3d < transfer.uncalibrated.metrics_all.rmse_3d;
}

bool ValidationRun::urdf_worse() const {
  return urdf &&
         urdf->metrics_all.rmse_3d > kWorseBeyondChance * transfer.uncalibrated.metrics_all.rmse_3d;
}

bool ValidationRun::plausible() const {
  return !(ErrorOf(transfer) > kImplausible * expected_error);
}

bool ValidationRun::as_predicted() const {
  return predicted == 0.0 || shown <= kWorseThanPredicted * predicted;
}

ValidationRun ValidateCalibration(const Project& given, const std::filesystem::path& calibration,
                                  const std::filesystem::path& recording,
                                  const TransferOptions& options) {
  const std::filesystem::path file = FindCalibrationFiles(calibration).calibration;
  ValidationRun run{.calibration = ReadCalibration(file),
                    .calibration_file = file.string(),
                    .recording = {},
                    .transfer = {},
                    .urdf = {},
                    .frozen = options.frozen,
                    .mistakes = {},
                    .not_judged = {},
                    .warnings = {}};
  Project project = given;
  project.elasticity = ElasticityOf(run.calibration, given);
  auto [measured, undone] = ReadAccepting(project, {recording}, options.accept, ReadFor::kAnyUse);
  for (const std::string& what : undone) run.warnings.push_back(DescribeUndone(what));
  const Measurements as_recorded = measured;
  const RecordedModel robot = MakeRecordedModel(project, options.seed, measured);
  CheckApplies(run.calibration, project, robot.model);
  CheckWaist(run, measured.calibration);
  const std::vector<MarkerMeasurement> places =
      KnowPlaces(options.marker_places, robot, measured.calibration, project, run);
  run.transfer = TransferTo(measured.calibration, robot, project, run);
  CompareWithPlaces(places, project.calibration.outlier_probability, run);
  const std::vector<RecordingMistake> mistakes =
      FindMistakesBy(project, options.seed, as_recorded, ErrorOf(run.transfer),
                     [&](const RecordedModel& plain, const Recording& corrected) {
                       return ErrorOn(corrected, plain, project, run);
                     });
  for (const RecordingMistake& mistake : mistakes) {
    run.mistakes.push_back(DescribeMistake(mistake));
  }
  if (run.mistakes.empty()) NameFaults(project, options.seed, as_recorded, robot, measured, run);
  if (!run.frozen) {
    run.urdf = RefitLike(run.transfer.calibrated, robot.model, measured.calibration, robot.base,
                         project.calibration, GeometryInUrdf(run.calibration, robot.model));
  }
  run.expected_error = ExpectedError(robot.model, measured.calibration, project.calibration.prior);
  run.recording = std::move(measured.calibration);
  run.warnings.insert(run.warnings.end(), measured.warnings.begin(), measured.warnings.end());
  NameUnused(measured.trials, run);
  WarnOfOutliers(run);
  CompareWithPrediction(project, recording, run);
  return run;
}

std::string ValidationStatus(const ValidationRun& run) {
  if (!run.converged()) return "not converged";
  if (!run.plausible()) return "implausible";
  return run.better() && !run.urdf_worse() ? "better" : "not better";
}

std::string MakeValidationJson(const ValidationRun& run) {
  Json json;
  json["status"] = ValidationStatus(run);
  json["calibration"] = run.calibration_file;
  json["calibration_fingerprint"] = run.calibration.fingerprint;
  json["frozen"] = run.frozen;
  json["recording"] = run.recording.source;
  json["own_recording"] = run.own_recording;
  json["postures"] = run.recording.posture_count();
  json["markers"] = run.recording.marker_count();
  std::vector<std::pair<const char*, const Refit*>> refits = {
      {"uncalibrated", &run.transfer.uncalibrated}, {"calibrated", &run.transfer.calibrated}};
  if (run.urdf) refits.emplace_back("urdf", &*run.urdf);
  for (const auto& [name, refit] : refits) {
    json["rmse_3d_mm"][name] = 1e3 * refit->metrics.rmse_3d;
    json["rmse_coordinate_mm"][name] = 1e3 * refit->metrics.rmse_coordinate;
    json["max_mm"][name] = 1e3 * refit->metrics.maximum;
    json["rmse_3d_mm_all"][name] = 1e3 * refit->metrics_all.rmse_3d;
    for (int m = 0; m < run.recording.marker_count(); ++m) {
      const double rmse = refit->metrics_all.marker_rmse_3d[m];
      json["by_marker"][run.recording.marker_names[m]]["rmse_3d_mm_all"][name] =
          std::isfinite(rmse) ? Json(1e3 * rmse) : Json(nullptr);
    }
  }
  if (run.predicted > 0.0) {
    json["predicted_mm"] = 1e3 * run.predicted;
    json["as_predicted"] = run.as_predicted();
  }
  json["expected_error_mm"] = 1e3 * run.expected_error;
  json["not_predicted"] = run.transfer.not_predicted;
  json["outliers"] = Json::array();
  for (const Outlier& outlier : run.transfer.calibrated.result.outliers) {
    json["outliers"].push_back({{"posture", outlier.posture},
                                {"marker", run.recording.marker_names[outlier.marker]},
                                {"residual_mm", 1e3 * outlier.residual}});
  }
  for (const PlaceResidual& place : run.places) {
    json["marker_places"].push_back({{"marker", place.marker},
                                     {"distance_mm", 1e3 * place.distance},
                                     {"in_sds", place.in_sds()}});
  }
  json["mistakes"] = run.mistakes;
  json["not_judged"] = run.not_judged;
  json["warnings"] = run.warnings;
  return JsonText(json);
}

}  // namespace elastocal
