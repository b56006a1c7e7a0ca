// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "elastocal/mistakes/observed_faults.hpp"
#include "elastocal/mistakes/observed_mistakes.hpp"
#include "elastocal/observation/contact_result.hpp"
#include "elastocal/observation/observed_study.hpp"
#include "elastocal/pipeline/contact_figures.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/contact_verdict.hpp"
#include "elastocal/pipeline/leave_out_touches.hpp"
#include "elastocal/recorded/choose_elasticity.hpp"
#include "elastocal/tables/read_file.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr int kUsualFolds = 10;

std::string JoinNames(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

ContactOutcome Estimate(const ObservedRobot& model, const Observations& observations, bool robot,
                        const ContactRunOptions& options, int folds) {
  const ObservationFreedom freedom{.robot = robot};
  ContactOutcome outcome;
  outcome.estimate = EstimateObserved(model, observations, freedom);
  outcome.left = LeftOf(model, observations, outcome.estimate.fit.values);
  outcome.in_sample = MakeFigures(model, observations, outcome.left);
  if (folds > 0) {
    outcome.held_out = CrossValidate(model, observations, freedom, folds, options.threads,
                                     robot ? options.progress : Progress());
  }
  return outcome;
}

/// The same model without compliances and causes, and without what is known of these; nothing where
/// it has none.
std::optional<ObservedRobot> WithGeometryOnly(const ObservedRobot& model,
                                              const Observations& observations,
                                              const Project& project,
                                              const std::optional<EarlierContacts>& earlier) {
  const std::vector<Parameter>& parameters = model.robot.parameters;
  const auto elastic = [](const Parameter& parameter) { return IsElastic(parameter.kind); };
  const auto compliance = [](const Parameter& parameter) { return IsCompliance(parameter.kind); };
  if (std::none_of(parameters.begin(), parameters.end(), elastic)) return std::nullopt;
  ObservationSetup setup = model.setup;
  if (std::any_of(parameters.begin(), parameters.end(), compliance)) {
    setup.hold.emplace_back("*.compliance_*");
  }
  const Elasticity& elasticity = model.robot.elasticity;
  ObservedRobot rigid = MakeObservedRobot(project.tree, project.placement, setup,
                                          elasticity.torsion, elasticity.bending);
  KeepObservedUnknowns(observations, rigid);
  rigid.earlier = model.earlier;
  // Springs that are zero have changed the others.
  if (earlier && !earlier->stored.urdf_errors.empty()) {
    for (std::size_t i = 0; i < rigid.earlier.names.size(); ++i) {
      const auto found = earlier->stored.urdf_errors.find(rigid.earlier.names[i]);
      if (found == earlier->stored.urdf_errors.end()) continue;
      rigid.earlier.mean[static_cast<Eigen::Index>(i)] = found->second;
    }
  }
  return rigid;
}

bool IsElasticityOpen(const Project& project) {
  return !project.elasticity.torsion && !project.elasticity.bending;
}

/// The model with torsion in all joints, and with the bending that it has; nothing where the robot
/// has no masses.
std::optional<ObservedRobot> WithTorsion(const ObservedRobot& rigid,
                                         const Observations& observations, const Project& project) {
  if (!HasMasses(project.tree)) return std::nullopt;
  std::vector<int> joints;
  for (std::size_t k = 0; k < project.tree.joints.size(); ++k) {
    joints.push_back(static_cast<int>(k));
  }
  ObservedRobot elastic =
      MakeObservedRobot(project.tree, project.placement, rigid.setup, joints,
                        rigid.robot.elasticity.bending, rigid.robot.elasticity.corrections);
  KeepObservedUnknowns(observations, elastic);
  return elastic;
}

/// Replaces the model by a wider one. The first estimate then becomes the geometry alone.
void Take(ObservedRobot wider, ContactOutcome outcome, ContactRun& run) {
  ContactOutcome narrow = std::exchange(run.calibrated, std::move(outcome));
  ObservedRobot before = std::exchange(run.model, std::move(wider));
  const std::vector<Parameter>& parameters = before.robot.parameters;
  if (std::any_of(parameters.begin(), parameters.end(),
                  [](const Parameter& parameter) { return IsElastic(parameter.kind); })) {
    return;
  }
  run.geometric = std::move(narrow);
  run.rigid_model = std::move(before);
}

// In standard errors: least gain by which elastic joints are taken.
constexpr double kElasticGain = 2.0;
constexpr const char* kTakenAsElastic =
    "joints are taken as elastic about their axes, which predicts postures that were left out "
    "better; elasticity in the project says otherwise where it is known";

/// Makes joints elastic, where the project leaves it open, if that lowers the error on held-out
/// postures by more than twice the standard error of the gain. Returns whether it did.
bool TakeElasticity(const Project& project, const ContactRunOptions& options, int folds,
                    ContactRun& run) {
  if (folds == 0 || !IsElasticityOpen(project)) return false;
  auto elastic = WithTorsion(run.model, run.observations, project);
  if (!elastic) return false;
  ContactOutcome outcome = Estimate(*elastic, run.observations, true, options, folds);
  const double gain = GainInSds(*elastic, run.observations, run.calibrated.held_out.left,
                                outcome.held_out.left, outcome.estimate.fit.spread);
  if (!(gain > kElasticGain) || outcome.estimate.fit.termination != Termination::kConverged) {
    return false;
  }
  Take(std::move(*elastic), std::move(outcome), run);
  run.springs_chosen = true;
  run.warnings.emplace_back(kTakenAsElastic);
  return true;
}

/// Adds causes beyond geometry and springs to the model (ChooseObservedCauses). Causes that the
/// program chose must also be significant in a complete estimate.
void TakeCauses(const Project& project, const ContactRunOptions& options, int folds,
                ContactRun& run) {
  ObservedCauses causes =
      ChooseObservedCauses(project, run.model, run.observations, run.calibrated.estimate.fit);
  run.causes = std::move(causes.report);
  run.extra = std::move(causes.extra);
  run.without_causes.reset();
  if (run.extra.empty()) return;
  if (run.causes && !FindObservedFault(run.model, run.observations, run.calibrated.estimate.fit)
                         .empty()) {  // a mistake in the table: no cause may hide it
    run.extra.clear();
    run.causes->search.accepted = false;
    return;
  }
  ObservedRobot with = WithCorrections(
      run.model, project.placement, run.observations,
      CorrectionsOf(ObservableCorrections(project.tree, run.model.setup), run.extra));
  ContactOutcome outcome = Estimate(with, run.observations, true, options, folds);
  const bool fails =
      outcome.estimate.fit.termination != Termination::kConverged ||
      (folds > 0 && !(GainInSds(with, run.observations, run.calibrated.held_out.left,
                                outcome.held_out.left, outcome.estimate.fit.spread) > 0.0));
  if (run.causes && fails) {
    run.extra.clear();
    run.causes->search.accepted = false;
    return;
  }
  if (run.causes) run.without_causes = ContactRun::Judged(run.calibrated);
  Take(std::move(with), std::move(outcome), run);
}

/// Removes the springs that were found before the causes, together with the causes, where springs
/// do not also lower the error beside the causes. Returns whether it did.
bool GiveUpElasticity(const Project& project, const ContactRunOptions& options, int folds,
                      ContactRun& run) {
  const ObservedRobot rigid = WithCorrections(*run.rigid_model, project.placement, run.observations,
                                              run.model.robot.elasticity.corrections);
  const ContactOutcome outcome = Estimate(rigid, run.observations, true, options, folds);
  if (outcome.estimate.fit.termination != Termination::kConverged ||
      GainInSds(run.model, run.observations, outcome.held_out.left, run.calibrated.held_out.left,
                run.calibrated.estimate.fit.spread) > kElasticGain) {
    return false;
  }
  run.model = std::move(*run.rigid_model);
  run.calibrated = std::move(*run.geometric);
  run.rigid_model.reset();
  run.geometric.reset();
  run.springs_chosen = false;
  std::erase(run.warnings, kTakenAsElastic);
  return true;
}

/// Warns where the project holds joints rigid and elastic joints predict held-out postures plainly
/// better than the causes that were taken, which may then stand for springs.
void WarnOfForbiddenSprings(const Project& project, const ContactRunOptions& options, int folds,
                            ContactRun& run) {
  const Elasticity& own = run.model.robot.elasticity;
  const bool chosen = run.causes.has_value() && !run.extra.empty();
  if (!chosen || folds == 0) return;
  const ObservedRobot rigid = WithCorrections(run.model, project.placement, run.observations, {});
  const auto elastic = WithTorsion(rigid, run.observations, project);
  if (!elastic || IsElasticityOpen(project)) return;
  if (elastic->robot.elasticity.torsion.size() <= own.torsion.size()) return;  // none is rigid
  const ContactOutcome outcome = Estimate(*elastic, run.observations, true, options, folds);
  if (GainInSds(*elastic, run.observations, run.calibrated.held_out.left, outcome.held_out.left,
                outcome.estimate.fit.spread) > kElasticGain) {
    run.warnings.push_back(DescribeForbiddenSprings(run.extra));
  }
}

/// Chooses springs and causes by the data. A large cause hides springs or looks like them, and a
/// missing spring looks like a cause. Where causes were found, springs are therefore chosen again
/// beside them and, if that changes the choice, causes again.
void ChooseBeyondGeometry(const Project& project, const ContactRunOptions& options, int folds,
                          ContactRun& run) {
  const bool springs = TakeElasticity(project, options, folds, run);
  TakeCauses(project, options, folds, run);
  if (run.extra.empty()) return;
  if (springs) {
    if (!GiveUpElasticity(project, options, folds, run)) return;
  } else {
    if (!TakeElasticity(project, options, folds, run)) return;
    run.model = WithCorrections(run.model, project.placement, run.observations, {});
    run.calibrated = Estimate(run.model, run.observations, true, options, folds);
  }
  TakeCauses(project, options, folds, run);
}

/// Estimates what is beside the nominal robot, and finds mistakes in the tables. Returns the number
/// of folds that the tables allow: none where there is a mistake, which would be held out as well.
int EstimateUncalibrated(const ContactRunOptions& options, int folds, ContactRun& run) {
  run.uncalibrated = Estimate(run.model, run.observations, false, options, folds);
  if (!LargeErrors(run.model, run.uncalibrated.in_sample).empty()) {
    run.mistakes = FindObservedMistakes(run.model, run.observations);
    if (!run.mistakes->empty()) {
      run.uncalibrated.held_out = {};
      return 0;
    }
  }
  if (ExchangeSessions(run) || LeaveOutTouchesInTheAir(run)) {
    folds = std::min(folds, run.observations.posture_count());
    run.uncalibrated = Estimate(run.model, run.observations, false, options, folds);
  }
  return folds;
}

/// Chooses the geometry of the URDF, which may be that of another fit, and makes the URDF.
void MakeUrdf(const Project& project, ZeroOffsets zero_offsets, int equations, ContactRun& run) {
  if (run.rigid_model) {
    run.in_urdf = ResultOfContacts(*run.rigid_model, run.geometric->estimate.fit, equations);
  }
  run.urdf = MakeCalibratedUrdf(ReadFile(project.urdf), project.urdf.string(),
                                run.in_urdf ? *run.in_urdf : run.result, zero_offsets);
  run.warnings.insert(run.warnings.end(), run.urdf->warnings.begin(), run.urdf->warnings.end());
}

}  // namespace

ContactRun CalibrateContacts(const Project& project,
                             const std::vector<std::filesystem::path>& recordings,
                             const ContactRunOptions& options) {
  ContactStart start = StartContacts(project, recordings, options);
  const std::optional<EarlierContacts>& earlier = start.earlier;
  ContactRun run;
  run.recording = JoinNames(start.observations.files);
  run.zero_offsets = options.zero_offsets;
  run.model = std::move(start.model);
  run.observations = std::move(start.observations);
  run.warnings = std::move(start.warnings);
  const int postures = run.observations.posture_count();
  run.closure = CheckClosure(run.model, run.observations.q);
  const int folds =
      EstimateUncalibrated(options, options.folds.value_or(std::min(kUsualFolds, postures)), run);
  run.calibrated = Estimate(run.model, run.observations, true, options, folds);
  if (earlier) {
    run.extra = CausesOf(run.model.robot.elasticity.corrections);
  } else if (!run.mistakes || run.mistakes->empty()) {
    ChooseBeyondGeometry(project, options, folds, run);
    WarnOfForbiddenSprings(project, options, folds, run);
  }
  const ObservationFit& fit = run.calibrated.estimate.fit;
  const auto left = [&](const ContactOutcome& outcome) {
    return folds > 0 ? outcome.held_out.left : outcome.left;
  };
  run.gain_in_sds = GainInSds(run.model, run.observations, left(run.uncalibrated),
                              left(run.calibrated), fit.spread);
  int equations = 0;
  for (const Observation& of : run.observations.all) {
    equations += run.model.instrument(of.instrument).size();
  }
  if (!run.geometric) {
    run.rigid_model = WithGeometryOnly(run.model, run.observations, project, earlier);
  }
  if (run.rigid_model && !run.geometric) {  // ten folds suffice for a figure beside the result
    run.geometric =
        Estimate(*run.rigid_model, run.observations, true, options, std::min(kUsualFolds, folds));
  }
  run.result = ResultOfContacts(run.model, fit, equations);
  JudgeContacts(run);
  if (run.deployable()) MakeUrdf(project, options.zero_offsets, equations, run);
  if (!run.extra.empty()) run.warnings.push_back(NotApplied(run.extra, false));
  for (std::string& outlier :
       DescribeOutliers(run.model, run.observations, run.calibrated.estimate)) {
    run.warnings.push_back(std::move(outlier));
  }
  return run;
}

std::string LeftInWords(const Instrument& instrument, const Eigen::VectorXd& left) {
  std::string text;
  std::string name;
  const std::vector<RowMeaning> rows = instrument.rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ShownUnit unit = ShownUnitOf(rows[i].unit);
    if (rows[i].name != name) text += (text.empty() ? "" : "; ") + std::string(rows[i].name);
    name = rows[i].name;
    text += fmt::format(" {:.3g}", unit.factor * left[static_cast<Eigen::Index>(i)]);
    if (i + 1 == rows.size() || rows[i + 1].name != name) text += std::string(" ") + unit.name;
  }
  return text;
}

std::vector<std::string> DescribeOutliers(const ObservedRobot& model,
                                          const Observations& observations,
                                          const ObservedEstimate& estimate) {
  std::vector<std::string> texts;
  for (const ObservationOutlier& outlier : estimate.outliers) {
    const Observation& observation = observations.all[outlier.observation];
    const PosturePlace& place = observations.postures[observation.posture];
    const Instrument& instrument = model.instrument(observation.instrument);
    const bool touch = model.IsPlate(observation.instrument);
    texts.push_back(Place(observations.files[place.file], place.line) +
                    fmt::format("{} '{}' contradicts the others and is left out: off by {}{}",
                                touch ? "the touch of plate" : "what is measured by",
                                instrument.name, LeftInWords(instrument, outlier.left),
                                touch ? "; was there contact?" : ""));
  }
  return texts;
}

}  // namespace elastocal
