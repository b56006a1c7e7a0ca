// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/calibration_details.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/cli/trial_report.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/parameter_names.hpp"

namespace elastocal::cli {
namespace {

constexpr std::size_t kMostListed = 10;

std::string Names(const CalibrationResult& result, const std::vector<int>& which) {
  return which.empty() ? "none" : JoinNames(result.model.parameters, which);
}

std::vector<int> WithStatus(const CalibrationResult& result, ParameterStatus status) {
  std::vector<int> which;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    if (result.status[i] == status) which.push_back(i);
  }
  return which;
}

/// Text after a list of which only the first entries are shown.
std::string More(std::size_t count) {
  return count > kMostListed ? fmt::format("  and {} more in summary.json\n", count - kMostListed)
                             : "";
}

std::string WideningText(const PriorScale& scale) {
  std::string text;
  for (int g = 0; g < kPriorGroupCount; ++g) {
    if (g >= 2 && scale.factor[g] == 1.0) continue;
    text +=
        fmt::format(" {:.2f} ({})", scale.factor[g], PriorGroupName(static_cast<PriorGroup>(g)));
  }
  return text;
}

std::string FitText(const CalibrationResult& result) {
  return fmt::format(
      "Fit: {} iterations, cost {:.4g} -> {:.4g}, {:.1f} ms; prior widened by{};\n"
      "  {:.1f} parameters determined by the data\n",
      result.iterations, result.initial_cost, result.final_cost, 1e3 * result.solve_seconds,
      WideningText(result.prior_scale), result.posterior.effective_parameters);
}

std::string AllEstimates(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  std::vector<int> which = WithStatus(result, ParameterStatus::kEstimated);
  std::erase_if(which, [&](int i) {
    const Parameter& parameter = result.model.parameters[i];
    const bool of_robot = parameter.joint >= 0 || parameter.linkage >= 0;
    return !of_robot || IsCompliance(parameter.kind);
  });
  return "\nEstimates\n" + EstimateTable(result, which) +
         "  theta: zero offset; r, d, b: lengths; alpha, beta, gamma: tilts of the axis (eq. 1)\n" +
         (result.model.tree.linkages.empty()
              ? ""
              : "  length, zero, radius, anchor, centre: of a rod and the crank of its motor\n") +
         "  * differs from nominal at 95 %\n";
}

std::string OutlierText(const CalibrationRun& run) {
  const auto& outliers = run.comparison.largest().outliers;
  if (outliers.empty()) return "\nOutliers: none\n";
  std::string text = fmt::format("\nOutliers (left out of the fit): {}\n", outliers.size());
  for (std::size_t i = 0; i < std::min(kMostListed, outliers.size()); ++i) {
    text += fmt::format("  {}: off by {:.3f} mm, {:.1f} times what is likely\n",
                        DescribeObservation(run.recording, outliers[i].posture, outliers[i].marker),
                        1e3 * outliers[i].residual, outliers[i].normalised);
  }
  return text + More(outliers.size());
}

std::string ExcitationText(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  const Excitation& excitation = run.excitation;
  return fmt::format(
      "\nExcitation by this recording: condition number {:.3g} (before the choice of identifiable "
      "parameters {:.3g}); O1 {:.4g}\n"
      "  hardly excited, leaning on the prior (sd above 1 deg or 5 mm without it): {}\n",
      excitation.condition_base, excitation.condition_all, excitation.indices.o1,
      Names(result, HardlyExcited(result.model.parameters, excitation)));
}

/// Text on correlations between parameters of the robot. Pairs of waist and markers, which are
/// correlated most, are left out because they tell little about the robot.
std::string Correlations(const CalibrationResult& result) {
  const auto name = [&](int i) { return result.model.parameters[i].name; };
  std::vector<Correlation> pairs = result.correlations;
  std::erase_if(pairs, [&](const Correlation& pair) {
    return IsExternal(result.model.parameters[pair.first].kind) ||
           IsExternal(result.model.parameters[pair.second].kind);
  });
  std::string text;
  for (std::size_t i = 0; i < std::min(kMostListed, pairs.size()); ++i) {
    text += fmt::format("  {:+.3f}  {}, {}\n", pairs[i].coefficient, name(pairs[i].first),
                        name(pairs[i].second));
  }
  return "\nStrong correlations of the robot's parameters\n" + (text.empty() ? "  none\n" : text) +
         More(pairs.size());
}

}  // namespace

std::string EstimateTable(const CalibrationResult& result, const std::vector<int>& which) {
  TextTable table({"parameter", "unit", "estimate", "sd", "95 % interval", ""});
  for (const int i : which) {
    const Parameter& parameter = result.model.parameters[i];
    const double value = InUserUnits(parameter, result.delta[i]);
    const double sd = InUserUnits(parameter, result.sd[i]);
    table.Add({parameter.name, UserUnit(parameter), RoundedTo(value, sd), RoundedSd(sd),
               RoundedInterval(value, result.interval_factor * sd, sd),
               Significant(result, i) ? "*" : ""});
  }
  return table.Render();
}

std::vector<std::string> DisplacedMarkers(const CalibrationResult& result) {
  constexpr double kFar = 0.02;  // m
  std::vector<std::string> markers;
  const int first = result.model.parameter_count() - 3 * result.model.marker_count();
  for (int m = 0; m < result.model.marker_count(); ++m) {
    const double distance = result.delta.segment<3>(first + 3 * m).norm();
    if (distance < kFar) continue;
    markers.push_back(fmt::format("{} {:.0f} mm", result.model.markers[m].name, 1e3 * distance));
  }
  return markers;
}

std::string DescribeDetails(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  const std::vector<std::string> displaced = DisplacedMarkers(result);
  return DescribeTrials(run) + FitText(result) + DescribeHeldOut(run) + AllEstimates(run) +
         DescribeElasticity(run) + DescribeFeet(run) +
         "\nKnown hardly better than beforehand, or only together with others: " +
         Names(result, WithStatus(result, ParameterStatus::kUnsupported)) +
         "\nHeld by the project: " + Names(result, WithStatus(result, ParameterStatus::kHeld)) +
         "\nMarkers more than 20 mm from where the project has them: " +
         (displaced.empty() ? "none" : FirstOf(displaced, displaced.size())) + "\n" +
         OutlierText(run) + ExcitationText(run) + Correlations(result);
}

}  // namespace elastocal::cli
