// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/choose_causes.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>

#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/observation/contact_result.hpp"
#include "elastocal/observation/observed_study.hpp"
#include "elastocal/pipeline/known_places.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {
namespace {

constexpr int kFewestPostures = 15, kLargestTable = 300;  // for a choice without being asked

/// Mean time of the postures, h, if their times differ.
std::optional<double> MeanHours(const Recording& recording) {
  if (recording.time_s.size() == 0 || recording.time_s.minCoeff() == recording.time_s.maxCoeff()) {
    return std::nullopt;
  }
  return recording.time_s.mean() / 3600.0;
}

/// All causes that a recording can show.
std::vector<std::string> PossibleCauses(const Project& project, const Recording& recording) {
  return CausesOf(PossibleCorrections(project.tree, MeanHours(recording), recording.marker_names));
}

std::vector<std::string> CausesMatching(const std::vector<std::string>& causes,
                                        const std::vector<std::string>& patterns) {
  std::vector<Parameter> names;
  for (const std::string& cause : causes) {
    names.push_back({cause, ParameterKind::kCorrection, ParameterUnit::kRadian});
  }
  CheckPatterns(names, patterns);
  std::vector<std::string> matching;
  for (int i : MatchParameters(names, patterns)) {
    matching.push_back(causes[static_cast<std::size_t>(i)]);
  }
  return matching;
}

/// The causes that the search took, without those that a calibration with all of them does not find
/// significant. These are removed one by one, also from the search.
template <typename CalibrateWith>
std::vector<std::string> TakeChosen(const CalibrateWith& calibrate_with, CauseSearch& search) {
  std::vector<std::string> extra;
  if (!search.accepted) return extra;
  for (const CauseFinding& finding : search.chosen) extra.push_back(finding.cause);
  while (!extra.empty()) {
    const std::optional<std::string> idle = IdleCause(calibrate_with(extra));
    if (!idle || std::erase(extra, *idle) == 0) return extra;
    std::erase_if(search.chosen, [&](const CauseFinding& one) { return one.cause == *idle; });
  }
  search.accepted = false;
  return extra;
}

std::vector<std::string> Without(std::vector<std::string> all,
                                 const std::vector<std::string>& some) {
  std::erase_if(all, [&](const std::string& one) {
    return std::find(some.begin(), some.end(), one) != some.end();
  });
  return all;
}

std::string Listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

bool MayChooseCauses(int postures) {
  return postures >= kFewestPostures && postures <= kLargestTable;
}

CauseReport StudyObservedCauses(const Project& project, const ObservedRobot& model,
                                const Observations& observations, const ObservationFit& fit,
                                std::optional<std::uint64_t> seed) {
  const ObservedRobot wide = WithCorrections(model, project.placement, observations,
                                             ObservableCorrections(project.tree, model.setup));
  const LinearStudy study = MakeObservedStudy(wide, model, observations, fit);
  CauseReport report;
  report.search = SearchCauses(study, {.seed = seed.value_or(1)});
  report.parameters = wide.robot.parameters;
  report.corrections = wide.robot.elasticity.corrections;
  report.postures = observations.posture_count();
  report.in_metres = false;
  CauseScene scene{.wide = wide.robot, .q = observations.q};
  const Eigen::VectorXd errors = ValuesOfWide(wide, model, fit.values).robot;
  scene.geometry = ApplyErrors(wide.robot, errors);
  scene.loads = ObservedLoads(wide, observations, errors);
  report.pictures = DrawCauses(study, report.search, scene);
  return report;
}

CauseReport StudyCauses(const Project& given, const Measurements& measured,
                        std::optional<std::uint64_t> seed,
                        const std::vector<MarkerMeasurement>& places) {
  Project project = given;
  if (!KnowsRobot(project.calibration.earlier)) project.elasticity.extra.clear();
  Measurements own = measured;
  const RecordedModel robot = MakeRecordedModel(project, seed, own, KnockSearch::kNone);
  const Recording& recording = own.calibration;
  std::vector<std::string> said_by_calibrate;
  const CalibrationResult result =
      CalibrateWithPlaces(places, robot, recording, project.calibration, said_by_calibrate);
  project.elasticity.hours = MeanHours(recording);
  project.elasticity.extra = PossibleCauses(project, recording);
  const ErrorModel wide =
      SelectMarkers(MakeProjectModel(project, recording.trials), recording.marker_names);
  const LinearStudy study = MakeLinearStudy(wide, recording, result, project.calibration);
  CauseReport report;
  report.search = SearchCauses(study, {.seed = seed.value_or(1)});
  report.parameters = wide.parameters;
  report.corrections = wide.elasticity.corrections;
  report.postures = recording.posture_count();
  report.pictures =
      DrawCauses(study, report.search, SceneOf(wide, recording, result, project.calibration));
  return report;
}

std::optional<CauseReport> ChooseCauses(const Measurements& measured,
                                        std::optional<std::uint64_t> seed, Project& project) {
  const ExtraCauses& asked = project.calibration.extra;
  const Recording& recording = measured.calibration;
  project.elasticity.hours = MeanHours(recording);
  project.elasticity.extra.clear();
  if (!asked.automatic) {
    project.elasticity.extra = CausesMatching(PossibleCauses(project, recording), asked.names);
    return std::nullopt;
  }
  if (!recording.trials.empty() || !MayChooseCauses(recording.posture_count())) return std::nullopt;
  CauseReport report;
  try {
    report = StudyCauses(project, measured, seed);
  } catch (const InputError&) {  // too few equations: the estimate will say so
    return std::nullopt;
  }
  const auto calibrate_with = [&](const std::vector<std::string>& extra) {
    Project with = project;
    with.elasticity.extra = extra;
    Measurements own = measured;
    const RecordedModel robot = MakeRecordedModel(with, seed, own, KnockSearch::kNone);
    return Calibrate(robot.model, own.calibration, robot.base, ModelKinds(robot.model).back(),
                     with.calibration);
  };
  project.elasticity.extra = TakeChosen(calibrate_with, report.search);
  return report;
}

ObservedCauses ChooseObservedCauses(const Project& project, const ObservedRobot& model,
                                    const Observations& observations, const ObservationFit& fit) {
  const ExtraCauses& asked = project.calibration.extra;
  const std::vector<Correction> possible = ObservableCorrections(project.tree, model.setup);
  ObservedCauses causes;
  if (!asked.automatic) {
    causes.extra = CausesMatching(CausesOf(possible), asked.names);
    return causes;
  }
  if (!MayChooseCauses(observations.posture_count())) return causes;
  causes.report = StudyObservedCauses(project, model, observations, fit, std::nullopt);
  const auto calibrate_with = [&](const std::vector<std::string>& extra) {
    const ObservedRobot with =
        WithCorrections(model, project.placement, observations, CorrectionsOf(possible, extra));
    return ResultOfContacts(with, EstimateObserved(with, observations, {}).fit, 0);
  };
  causes.extra = TakeChosen(calibrate_with, causes.report->search);
  return causes;
}

std::optional<std::string> IdleCause(const CalibrationResult& result) {
  constexpr double kPlain = 0.9545;  // probability within two standard deviations of one parameter
  std::map<std::string, std::vector<Eigen::Index>> entries;  // rows of the posterior, by cause
  const std::vector<int>& known = result.posterior.parameters;
  for (std::size_t k = 0; k < known.size(); ++k) {
    const int correction = result.model.parameters[static_cast<std::size_t>(known[k])].correction;
    const auto row = static_cast<Eigen::Index>(k);
    if (correction < 0 || !(result.posterior.covariance(row, row) > 0.0)) continue;
    entries[result.model.elasticity.corrections[static_cast<std::size_t>(correction)].cause]
        .push_back(row);
  }
  std::optional<std::string> least;
  double smallest = 1.0;
  for (const auto& [cause, at] : entries) {
    const auto count = static_cast<Eigen::Index>(at.size());
    Eigen::VectorXd size(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      size[i] = result.delta[known[static_cast<std::size_t>(at[static_cast<std::size_t>(i)])]];
    }
    const Eigen::MatrixXd information = InverseOfInformation(result.posterior.covariance(at, at));
    const double of_limit =
        size.dot(information * size) / ChiSquareQuantile(kPlain, static_cast<double>(count));
    if (!(of_limit <= smallest)) continue;
    smallest = of_limit;
    least = cause;
  }
  return least;
}

std::vector<std::string> NeverApplied(const std::vector<std::string>& causes) {
  constexpr std::string_view kUnknownAtRunTime[] = {".drift", ".creep"};  // of one recording
  std::vector<std::string> never;
  std::copy_if(causes.begin(), causes.end(), std::back_inserter(never), [&](const auto& cause) {
    return std::any_of(std::begin(kUnknownAtRunTime), std::end(kUnknownAtRunTime),
                       [&](std::string_view end) { return cause.ends_with(end); });
  });
  return never;
}

std::string CompensationInWords(bool springs, const std::vector<std::string>& causes) {
  const std::vector<std::string> never = NeverApplied(causes);
  std::vector<std::string> applied = Without(causes, never);
  if (springs) applied.insert(applied.begin(), "elasticity");
  std::string text;
  for (std::size_t i = 0; i < applied.size(); ++i) {
    const bool last = i + 1 == applied.size() && never.empty();
    text += (i == 0 ? "" : last ? " and " : ", ") + applied[i];
  }
  if (!never.empty()) {
    text += (text.empty() ? "" : " and of ") + Listed(never) + ", which no export applies";
  }
  return "compensation of " + text;
}

std::string DescribeForbiddenSprings(const std::vector<std::string>& causes) {
  return Listed(causes) +
         ": joints that give way would predict postures that were left out better, but elasticity "
         "in the project holds joints rigid: without that key, springs are estimated where they "
         "help";
}

std::string NotApplied(const std::vector<std::string>& causes, bool at_run_time) {
  const std::vector<std::string> never = NeverApplied(causes);
  const std::vector<std::string> applied = Without(causes, never);
  std::string text;
  if (!applied.empty() && !at_run_time) {
    text =
        Listed(applied) +
        ": estimated beside geometry and springs; compensate and export --format c99 and runtime "
        "apply it, a URDF and other formats cannot";
  }
  if (!never.empty()) {
    text += (text.empty() ? "" : "; ") + Listed(never) +
            ": estimated beside geometry and springs; no export applies it";
  }
  return text;
}

std::vector<std::string> StoredCauses(const RobotTree& tree,
                                      const std::map<std::string, double>& joint_errors) {
  std::vector<Correction> stored;
  for (const Correction& correction : PossibleCorrections(tree, std::nullopt)) {
    if (joint_errors.contains(correction.name)) stored.push_back(correction);
  }
  return CausesOf(stored);
}

}  // namespace elastocal
