// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_check.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observation_faults.hpp"
#include "elastocal/pipeline/check_json.hpp"
#include "elastocal/pipeline/contact_earlier.hpp"
#include "elastocal/pipeline/contact_faults.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/contact_verdict.hpp"
#include "elastocal/pipeline/observed_corrections.hpp"
#include "elastocal/pipeline/observed_mistakes.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFewestChecked = 4;

/// What a robot with these errors leaves once all beside it is fitted.
ObservationFigures FiguresOf(const ContactCheck& run, const Eigen::VectorXd& errors) {
  ObservationFit start = StartFit(run.model, run.observations);
  start.values.robot = errors;
  start.loads = ObservedLoads(run.model, run.observations, errors);
  const ObservationFit fit = FitObservations(run.model, run.observations, start,
                                             {.freedom = {.robot = false}, .robust = true});
  return MakeFigures(run.model, run.observations, LeftOf(run.model, run.observations, fit.values));
}

/// Whether the robot is as it was calibrated in other observations of the same day.
bool Holds(const ContactCheck& run, const EarlierContacts& earlier, const EarlierEstimate& known,
           const Observations& observations, const Project& project,
           const JointCheckOptions& options) {
  ContactCheck other = run;
  other.observations = observations;
  other.calibrated = FiguresOf(other, StoredErrors(earlier.stored, run.model.robot));
  other.check = OpenJoints(run.model, known, observations, project, options).check;
  return !other.check.changed() && other.FarRows(other.calibrated).empty();
}

/// Without the postures in which something contradicts the others.
Observations WithoutOutliers(const Observations& observations,
                             const std::vector<ObservationOutlier>& outliers) {
  std::vector<char> bad(Size(observations.posture_count()), 0);
  for (const ObservationOutlier& outlier : outliers) {
    bad[Size(observations.all[Size(outlier.observation)].posture)] = 1;
  }
  std::vector<int> good;
  for (int i = 0; i < observations.posture_count(); ++i) {
    if (bad[Size(i)] == 0) good.push_back(i);
  }
  return SelectPostures(observations, good);
}

/// Single observations and faults beside a robot that is as it was calibrated, without each of
/// which it holds.
std::vector<std::string> FindAlternatives(const ContactCheck& run, const EarlierContacts& earlier,
                                          const EarlierEstimate& known, const Project& project,
                                          const JointCheckOptions& options) {
  constexpr std::size_t kMostTried = 8;
  constexpr double kMostOthers = 0.75;  // of the postures
  ObservedRobot calibrated = run.model;
  calibrated.earlier = known;
  const ObservedEstimate estimate = EstimateObserved(calibrated, run.observations, {});
  std::vector<ObservationFault> faults =
      FindObservationFaults(calibrated, run.observations, estimate.fit);
  if (faults.size() > kMostTried) faults.resize(kMostTried);
  std::vector<std::string> alternatives;
  const Observations others = WithoutOutliers(run.observations, estimate.outliers);
  if (!estimate.outliers.empty() && others.posture_count() >= kFewestChecked &&
      others.posture_count() >= kMostOthers * run.observations.posture_count() &&
      Holds(run, earlier, known, others, project, options)) {
    alternatives.push_back(fmt::format(
        "{}", fmt::join(DescribeOutliers(calibrated, run.observations, estimate), ", and ")));
  }
  for (const ObservationFault& found : faults) {
    // Beside errors as small as a moved joint's, some split of the rows explains them by chance;
    // from the first row on, that is a joint or a mounting that has moved.
    const bool from = found.kind == ObservationFaultKind::kJointOffset ||
                      found.kind == ObservationFaultKind::kJointDrift ||
                      found.kind == ObservationFaultKind::kMoved;
    if (from && (found.posture == 0 || run.explained())) continue;
    const ObservationFault fault = Refined(found, calibrated, run.observations);
    const Observations without = WithoutFault(fault, calibrated, run.observations);
    if (without.posture_count() < kFewestChecked) continue;
    if (!Holds(run, earlier, known, without, project, options)) continue;
    alternatives.push_back(DescribeWithRemedy(fault, calibrated, run.observations));
  }
  return alternatives;
}

}  // namespace

std::vector<std::string> ContactCheck::FarRows(const ObservationFigures& figures) const {
  constexpr double kMore = 4.0, kMatters = 0.02;
  std::vector<std::string> far;
  for (std::size_t i = 0; i < figures.rows.size(); ++i) {
    const RowErrors& row = figures.rows[i];
    if (row.unit == SourceUnit::kNone) continue;
    const double most = std::max(kMore * left_before[i], kMatters * LargestError(model, row.unit));
    if (!(row.rms > most)) continue;
    const ShownUnit unit = ShownUnitOf(row.unit);
    far.push_back(fmt::format("{} of {} off by {:.3g} {}, where the calibration left {:.2g}",
                              row.row, model.instrument(row.instrument).name, unit.factor * row.rms,
                              unit.name, unit.factor * left_before[i]));
  }
  return far;
}

bool ContactCheck::recording_explains() const {
  const bool by_one_joint = check.moved.size() == 1 && check.suspects.empty() && explained();
  return !alternatives.empty() && !by_one_joint;
}

bool ContactCheck::unchanged() const {
  return converged && mistakes.empty() && !check.changed() && explained() &&
         !changed_beyond_telling();
}

ContactCheck CheckContacts(const Project& project, const std::filesystem::path& calibration,
                           const std::vector<std::filesystem::path>& recordings,
                           const CheckOptions& options) {
  const EarlierContacts earlier = ReadEarlierContacts(calibration, project);
  ObservationTables tables = ReadObservationTables(recordings, project, &earlier.contacts.feet);
  ContactCheck run;
  run.calibration_file = earlier.stored.source;
  run.recording = fmt::format("{}", fmt::join(tables.observations.files, ", "));
  run.model = MakeRobotAfterEarlier(earlier, project, tables);
  run.observations = std::move(tables.observations);
  run.warnings = std::move(tables.warnings);
  for (const std::string& what : CorrectObservations(options.accept, run.model, run.observations)) {
    run.warnings.push_back("corrected on request: " + what);
  }
  if (run.observations.posture_count() < kFewestChecked) {
    throw InputError(run.recording + ": " + std::to_string(run.observations.posture_count()) +
                     " postures; at least " + std::to_string(kFewestChecked) + " were expected");
  }
  const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(run.model.robot.parameter_count());
  run.uncalibrated = FiguresOf(run, nominal);
  run.calibrated = FiguresOf(run, StoredErrors(earlier.stored, run.model.robot));
  for (const RowErrors& row : run.calibrated.rows) {
    run.left_before.push_back(NoiseOf(run.model, row, earlier.contacts.calibrated.spread));
  }
  if (!LargeErrors(run.model, run.calibrated).empty()) {
    run.mistakes = FindObservedMistakes(run.model, run.observations);
  }

  const EarlierEstimate known = MakeEarlierOfContacts(earlier, run.model, project, options.days);
  OpenedRobot opened = OpenJoints(run.model, known, run.observations, project, options.joints);
  run.check = std::move(opened.check);
  run.converged = opened.estimate.fit.termination == Termination::kConverged;
  run.updated = MakeFigures(run.model, run.observations,
                            LeftOf(run.model, run.observations, opened.estimate.fit.values));
  if (run.mistakes.empty() && !run.unchanged()) {
    run.alternatives = FindAlternatives(run, earlier, known, project, options.joints);
  }
  for (std::string& text : DescribeOutliers(run.model, run.observations, opened.estimate)) {
    run.warnings.push_back(std::move(text));
  }
  return run;
}

std::string CheckStatus(const ContactCheck& run) {
  if (!run.mistakes.empty() || run.recording_explains()) return "recording wrong";
  if (!run.converged) return "not converged";
  if (!run.explained()) return "unexplained";
  if (!run.check.moved.empty()) return "moved";
  return run.unchanged() ? "unchanged" : "changed";
}

std::string MakeCheckJson(const ContactCheck& run) {
  Json json;
  json["status"] = CheckStatus(run);
  json["calibration"] = run.calibration_file;
  json["recording"] = run.recording;
  json["postures"] = run.observations.posture_count();
  json["contact"] = FiguresJson(run.model, run.calibrated);
  json["contact"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated);
  json["contact"]["updated"] = FiguresJson(run.model, run.updated);
  AddJointCheck(run.check, json);
  json["mistakes"] = run.mistakes;
  json["alternatives"] = run.alternatives;
  json["warnings"] = run.warnings;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace elastocal
