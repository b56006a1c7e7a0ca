// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/calibration_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "elastocal/calibration/nominal_places.hpp"
#include "elastocal/cli/calibration_details.hpp"
#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/find_faults.hpp"
#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/pipeline/coverage.hpp"

namespace elastocal::cli {
namespace {

constexpr std::size_t kMostParameters = 10;
constexpr std::size_t kMostNamed = 5;

/// Text on trials that are not used, which the verdict does not cover.
std::string RefusedText(const CalibrationRun& run) {
  std::string text;
  for (const TrialSummary& trial : run.trials) {
    if (trial.refused.empty()) continue;
    text += "Not used: trial " + trial.trial.name + ": " + trial.refused + "\n";
  }
  return text;
}

/// Held-out errors without outliers, next to those of all observations; empty where no observation
/// is an outlier.
std::string WithoutOutliersText(const CalibrationRun& run) {
  const std::size_t left_out = run.comparison.largest().outliers.size();
  if (run.held_out || run.cross_validation.folds == 0 || left_out == 0) return "";
  const auto error = [&](ModelKind kind) {
    const auto& metrics = run.cross_validation.metrics_without_outliers;
    return Millimetres(metrics[static_cast<std::size_t>(kind)].rmse_3d, 3);
  };
  std::string text =
      fmt::format("; without the {} sightings that the fit left out from {} to {} mm by the URDF",
                  left_out, error(ModelKind::kUncalibrated), error(run.deployment.urdf_kind));
  if (std::isfinite(run.deployment.compensated)) {
    text += fmt::format(", {} mm by the largest model", error(run.comparison.largest_kind()));
  }
  return text;
}

/// Whether a prismatic joint moved far enough to determine the scale of the cameras, because its
/// gear is not estimated.
bool SlideTellsScale(const CalibrationRun& run) {
  constexpr double kFar = 0.1;  // m
  const ErrorModel& model = run.comparison.largest().model;
  return std::any_of(model.active_joints.begin(), model.active_joints.end(), [&](const int joint) {
    const Joint& slide = model.tree.joints[static_cast<std::size_t>(joint)];
    const auto moved = run.recording.q.col(slide.coordinate);
    return slide.type == JointType::kPrismatic && moved.maxCoeff() - moved.minCoeff() > kFar &&
           std::find(run.extra.begin(), run.extra.end(), slide.name + ".gear") == run.extra.end();
  });
}

/// A wrong scale of the cameras looks like a robot of another size and leaves no residual. If
/// neither a known length nor a prismatic joint determines the scale, the text states the range
/// that the robot's own lengths leave open, if that is more than the error in the verdict; else
/// empty.
std::string ScaleText(const CalibrationRun& run) {
  if (!run.common_scale || ScaleIsKnown(run.trials) || SlideTellsScale(run)) return "";
  const auto [least, most] = CompatibleScales(*run.common_scale);
  const double reach = 0.5 * RobotSize(run.comparison.largest().model.tree);
  const double open = std::max(std::abs(least), std::abs(most)) * reach;
  const Deployment& deployment = run.deployment;
  if (!(open > std::fmin(deployment.urdf, deployment.compensated))) return "";
  return fmt::format(
      "  The scale of the cameras is taken as right: no known length was in view, and the robot's "
      "own lengths only tell that it is {:.4f} to {:.4f} times the true one (95 %). That may put "
      "what is {:.2g} m from the root link up to {:.2g} mm off, which no error above shows "
      "(recording.reference_lengths tells).\n",
      1.0 + least, 1.0 + most, reach, 1e3 * open);
}

/// Intervals of the held-out errors in the verdict, and what these errors do not cover.
std::string HeldOutText(const CalibrationRun& run) {
  const Deployment& deployment = run.deployment;
  const auto between = [](const RmseInterval& interval) {
    return Millimetres(interval.low, 2) + " to " + Millimetres(interval.high, 2) + " mm";
  };
  std::string text = ".\n  On held-out postures" + WithoutOutliersText(run) + ".\n";
  if (deployment.urdf_interval) {
    text += "  Of many such postures, 95 % interval: " + between(*deployment.urdf_interval);
    if (deployment.compensated_interval) {
      text += " and " + between(*deployment.compensated_interval);
    }
    text += ".\n";
  }
  return text +
         "  Another day and other postures may show more: before deploying, validate on another "
         "recording.\n";
}

/// Which calibrated joints and chains no held-out data judge; empty where they judge all.
std::string ExceptNotJudged(const CalibrationRun& run) {
  const std::vector<std::string> not_judged = NotJudged(run.coverage);
  if (not_judged.empty()) return "";
  return ", but no held-out data judge " + FirstOf(not_judged, kMostNamed);
}

/// The verdict in one sentence.
std::string VerdictText(const CalibrationRun& run) {
  if (!run.verdict.objections.empty()) {
    return "Verdict: do not deploy. " + run.verdict.objections.front() + "\n";
  }
  const Deployment& deployment = run.deployment;
  const bool on_trials = deployment.judged_on == "held-out trials";
  const std::string deploy =
      on_trials ? "deploy" + ExceptNotJudged(run) + ". On held-out motions " : "";
  std::string text =
      fmt::format("Verdict: {}from {} to {} mm by the URDF alone", deploy,
                  Millimetres(deployment.uncalibrated, 3), Millimetres(deployment.urdf, 3));
  if (std::isfinite(deployment.compensated)) {
    const std::vector<Parameter>& parameters = run.comparison.largest().model.parameters;
    const bool springs = std::any_of(parameters.begin(), parameters.end(),
                                     [](const Parameter& p) { return IsCompliance(p.kind); });
    text += fmt::format(", {} mm with {}", Millimetres(deployment.compensated, 3),
                        CompensationInWords(springs, run.extra));
  }
  if (on_trials) return text + ".\n" + ScaleText(run);
  const bool folded = run.cross_validation.folds > 0;
  return text +
         (folded ? HeldOutText(run)
                 : fmt::format(
                       ".\n  In the fit{}. Before deploying, cross-validate (--kfold 10) and "
                       "validate on another recording.\n",
                       run.held_out ? ", because no trial for validation could be judged" : "")) +
         ScaleText(run);
}

/// Text where bodies scatter more than their markers do; else empty. Positions that are commanded
/// instead of measured, a robot that swings, and effects that no model describes all add noise to
/// each posture and cannot be told apart.
std::string BodyNoiseText(const Noise& noise) {
  const auto largest = [&](NoiseSource source) {
    double most = 0.0;
    for (int g = 0; g < noise.group_count(); ++g) most = std::max(most, noise(g, source));
    return most;
  };
  constexpr double kLeast = 1e-4, kLeastOfMarker = 0.5;  // m; of the noise of a marker
  const double bodies = largest(NoiseSource::kBodyPosition);
  if (bodies < std::max(kLeast, kLeastOfMarker * largest(NoiseSource::kMarker))) return "";
  return fmt::format(
      ", of a body as a whole {:.3g} mm (not at rest, positions that are commanded instead of "
      "measured, loose joints, or more than the model knows)",
      1e3 * bodies);
}

std::string Overview(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  const auto used = std::count_if(run.trials.begin(), run.trials.end(),
                                  [](const TrialSummary& trial) { return trial.refused.empty(); });
  return fmt::format(
      "{}: {} postures{}, {} markers, {} equations\n"
      "{} of {} parameters identifiable (theory {}); {} model {} after {} iterations\n"
      "Noise of a marker coordinate {:.3g} mm{}\n",
      result.model.tree.name, run.recording.posture_count(),
      run.trials.empty() ? "" : fmt::format(" ({} of {} trials used)", used, run.trials.size()),
      run.recording.marker_count(), result.equations, run.base.geometric_count,
      result.model.parameter_count(), run.base.theoretical_count, ModelKindName(result.kind),
      TerminationName(result.termination), result.iterations, 1e3 * result.marker_sd,
      BodyNoiseText(result.noise));
}

/// Table of RMSE and largest distance of each model.
std::string ModelTable(const CalibrationRun& run) {
  const int folds = run.cross_validation.folds;
  const bool knows_waist =
      std::any_of(run.waist_error.begin(), run.waist_error.end(),
                  [](double error) { return std::isfinite(error) && error != 0.0; });
  std::vector<std::string> header = {"model", "fit RMSE", "largest"};
  if (folds > 0) header.insert(header.end(), {fmt::format("{}-fold RMSE", folds), "largest"});
  if (run.held_out) header.emplace_back("held-out motions RMSE");
  if (knows_waist) header.emplace_back("true waist RMSE");
  TextTable table(header);
  for (const ModelKind kind : run.comparison.kinds) {
    const auto index = static_cast<std::size_t>(kind);
    const ErrorMetrics& fit = run.comparison.metrics[index];
    std::vector<std::string> row = {ModelKindName(kind), Millimetres(fit.rmse_3d, 3),
                                    Millimetres(fit.maximum, 3)};
    if (folds > 0) {
      const ErrorMetrics& folded = run.cross_validation.metrics[index];
      row.insert(row.end(), {Millimetres(folded.rmse_3d, 3), Millimetres(folded.maximum, 3)});
    }
    if (run.held_out) {
      const auto& mean = run.held_out->table.mean_rmse_3d;
      const auto value = mean.find(kind);
      row.push_back(value == mean.end() ? "-" : Millimetres(value->second, 3));
    }
    if (knows_waist) row.push_back(Millimetres(run.waist_error[index], 3));
    table.Add(row);
  }
  return (run.trials.empty()
              ? "\nDistance of markers from the model, waist and markers fitted, mm\n"
              : "\nDistance of markers from where their foot (or the waist) puts them, mm\n") +
         table.Render();
}

/// Text that the project's marker positions are good enough for a narrower prior.
std::string NominalPlacesText(const NominalPlaces& places) {
  if (!places.worth_telling()) return "";
  return fmt::format(
      "The places of markers in the project are off by {0:.1f} mm (sd of a coordinate), where the "
      "recording tells it\n(in {1:.0f} directions). If those of hands, feet and waist were "
      "measured as well as the\nothers, say so (calibration: {{prior: {{marker_mm: {0:.1f}}}}}): "
      "the errors above become smaller.\n",
      1e3 * places.sd, places.directions);
}

/// Expected errors of the ends of limbs, which no marker errors show.
std::string FramesText(const CalibrationRun& run) {
  if (run.frames.empty()) return "";
  TextTable table({"end of a limb", "position mm", "attitude deg"});
  for (const FramePrecision& frame : run.frames) {
    const Link& link = run.comparison.largest().model.tree.links[Size(frame.link)];
    table.Add({link.name, RoundedSd(1e3 * frame.position_sd),
               RoundedSd(frame.attitude_sd * 180.0 / M_PI)});
  }
  return "\nError to be expected (sd) of the URDF between the root link and the ends of limbs, "
         "springs aside.\nFitted markers do not show it; the more of their places are measured "
         "(--marker-places), the smaller it is.\n" +
         table.Render() + NominalPlacesText(AssessNominalPlaces(run.comparison.largest()));
}

/// Parameters of the robot that differ from nominal at 95 %, the furthest first. They are compared
/// in units that are usual for their kind, so that angles, lengths and compliances have one order.
std::vector<int> Remarkable(const CalibrationResult& result) {
  const Prior usual;
  std::vector<int> order;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (!IsExternal(parameter.kind) && Significant(result, i)) order.push_back(i);
  }
  const auto size = [&](int i) {
    return std::abs(result.delta[i]) / usual.Of(result.model.tree, result.model.parameters[i]);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size(a) > size(b); });
  return order;
}

std::string ParametersText(const CalibrationResult& result) {
  std::vector<int> order = Remarkable(result);
  if (order.empty()) return "\nNo parameter differs from nominal at 95 %\n";
  const std::size_t all = order.size();
  order.resize(std::min(all, kMostParameters));
  return fmt::format("\nFurthest from nominal, of {} parameters that differ from it at 95 % (*)\n",
                     all) +
         EstimateTable(result, order);
}

/// Counts as text, the most frequent first: "a 12, b 3 and 4 more".
std::string Counts(const std::map<std::string, int>& counts) {
  std::vector<std::pair<std::string, int>> order(counts.begin(), counts.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<std::string> words;
  for (const auto& [name, count] : order) words.push_back(fmt::format("{} {}", name, count));
  return FirstOf(words, kMostNamed);
}

std::string OutlierLine(const CalibrationRun& run) {
  const auto& outliers = run.comparison.largest().outliers;
  if (outliers.empty()) return "";
  std::map<std::string, int> counts;
  for (const Outlier& outlier : outliers) ++counts[run.recording.marker_names[outlier.marker]];
  return fmt::format("  {} of {} sightings are outliers, left out: {}\n", outliers.size(),
                     SeenMask(run.recording).count(), Counts(counts));
}

std::string Line(const std::string& what, const std::vector<std::string>& which) {
  return which.empty() ? "" : "  " + what + ": " + FirstOf(which, kMostNamed) + "\n";
}

std::string TrialLines(const CalibrationRun& run) {
  std::vector<std::string> refused, knocked;
  for (const TrialSummary& trial : run.trials) {
    if (!trial.refused.empty()) refused.push_back(trial.trial.name);
  }
  for (const Knock& knock : run.knocks) {
    knocked.push_back(fmt::format("{} by {:.1f} mm", knock.cluster, 1e3 * knock.distance));
  }
  return Line("trials not used", refused) + Line("clusters of markers knocked", knocked);
}

std::string FeetLine(const CalibrationResult& result) {
  std::string text;
  if (!result.slips.empty()) {
    const auto furthest =
        std::max_element(result.slips.begin(), result.slips.end(),
                         [](const Slip& a, const Slip& b) { return a.distance < b.distance; });
    text += fmt::format("  feet (or the held root) slipped {} times, by at most {:.1f} mm\n",
                        result.slips.size(), 1e3 * furthest->distance);
  }
  if (!result.loose_footings.empty()) {
    text += fmt::format("  the waist is not where its leg puts it in {} postures, left out\n",
                        result.loose_footings.size());
  }
  return text;
}

std::string UncertainLine(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  const auto count = [&](ParameterStatus status) {
    return std::count(result.status.begin(), result.status.end(), status);
  };
  const std::size_t weak = HardlyExcited(result.model.parameters, run.excitation).size();
  return fmt::format(
      "  parameters: {} known hardly better than beforehand, {} held; {} hardly excited\n",
      count(ParameterStatus::kUnsupported), count(ParameterStatus::kHeld), weak);
}

std::string LookAt(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  return "\nTo look at\n" + TrialLines(run) + OutlierLine(run) + FeetLine(result) +
         Line("markers more than 20 mm from where the project has them", DisplacedMarkers(result)) +
         UncertainLine(run);
}

}  // namespace

std::string DescribeRun(const CalibrationRun& run, bool verbose) {
  // Estimates that a named mistake has spoilt would mislead.
  const bool spoilt = !run.faults.empty() && !verbose;
  const std::string estimates =
      spoilt ? "" : FramesText(run) + ParametersText(run.comparison.largest());
  const std::string screen = RefusedText(run) + VerdictText(run) + "\n" + Overview(run) +
                             ModelTable(run) + estimates + LookAt(run);
  return screen + (verbose ? "\n" + DescribeDetails(run)
                           : "  all parameters, elasticity and correlations: --verbose\n");
}

}  // namespace elastocal::cli
