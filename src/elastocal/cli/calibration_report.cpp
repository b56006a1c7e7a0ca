#include "elastocal/cli/calibration_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/cli/trial_report.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/parameter_names.hpp"

namespace elastocal::cli {
namespace {

std::string Millimetres(double metres) {
  return std::isfinite(metres) ? fmt::format("{:.3f}", 1e3 * metres) : "-";
}

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

std::string ParameterTable(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  const std::vector<int> weak =
      HardlyExcited(result.model.parameters, run.base.kept, run.excitation);
  TextTable table({"parameter", "unit", "estimate", "sd", "95 % interval", ""});
  for (int i : WithStatus(result, ParameterStatus::kEstimated)) {
    const Parameter& parameter = result.model.parameters[i];
    if (parameter.joint < 0 || IsCompliance(parameter.kind)) continue;
    const double value = InUserUnits(parameter, result.delta[i]);
    const double sd = InUserUnits(parameter, result.sd[i]);
    const double half = result.interval_factor * sd;
    const bool is_weak = std::binary_search(weak.begin(), weak.end(), i);
    table.Add({parameter.name, UserUnit(parameter), fmt::format("{:.4f}", value),
               fmt::format("{:.4f}", sd),
               fmt::format("[{:.4f}, {:.4f}]", value - half, value + half),
               std::string(Significant(result, i) ? "*" : "") + (is_weak ? " weak" : "")});
  }
  return table.Render() +
         "  theta: zero offset; r, d, b: lengths; alpha, beta, gamma: tilts of the axis (eq. 1)\n"
         "  * differs from nominal at 95 %; weak: hardly excited by this recording, leans on the "
         "prior\n";
}

std::string OutlierText(const CalibrationRun& run) {
  constexpr std::size_t kMost = 10;
  const auto& outliers = run.comparison.largest().outliers;
  if (outliers.empty()) return "Outliers: none\n";
  std::string text = fmt::format("Outliers (left out of the fit): {}\n", outliers.size());
  for (std::size_t i = 0; i < std::min(kMost, outliers.size()); ++i) {
    text += fmt::format("  {}: off by {:.3f} mm, {:.1f} times what is likely\n",
                        DescribeObservation(run.recording, outliers[i].posture, outliers[i].marker),
                        1e3 * outliers[i].residual, outliers[i].normalised);
  }
  if (outliers.size() > kMost) {
    text += fmt::format("  and {} more in summary.json\n", outliers.size() - kMost);
  }
  return text;
}

/// Markers whose estimated position is far from the project's: measured roughly, on another link,
/// or exchanged.
std::string MarkerText(const CalibrationResult& result) {
  constexpr double kFar = 0.02;  // m
  std::string text;
  const int first = result.model.parameter_count() - 3 * result.model.marker_count();
  for (int m = 0; m < result.model.marker_count(); ++m) {
    const double distance = result.delta.segment<3>(first + 3 * m).norm();
    if (distance < kFar) continue;
    text += fmt::format("{}{} {:.0f} mm", text.empty() ? "" : ", ", result.model.markers[m].name,
                        1e3 * distance);
  }
  return "Markers more than 20 mm from where the project has them: " +
         (text.empty() ? "none" : text) + "\n";
}

/// One sentence for whoever reads no table.
std::string Conclusion(const CalibrationRun& run) {
  if (!run.verdict.objections.empty()) return "Verdict: do not deploy (see the errors).\n";
  if (run.held_out) {
    const auto& mean = run.held_out->table.mean_rmse_3d;
    return fmt::format("Verdict: deploy. Markers of held-out motions: from {} to {} mm.\n",
                       Millimetres(mean.at(ModelKind::kUncalibrated)),
                       Millimetres(mean.at(run.comparison.largest_kind())));
  }
  const bool held_out = run.cross_validation.folds > 0;
  const auto& metrics = held_out ? run.cross_validation.metrics : run.comparison.metrics;
  return fmt::format(
      "Verdict: from {} to {} mm {}. {}\n", Millimetres(metrics[0].rmse_3d),
      Millimetres(metrics[static_cast<int>(run.comparison.largest_kind())].rmse_3d),
      held_out ? "on held-out postures" : "in the fit",
      held_out ? "Before deploying, validate on another recording."
               : "Cross-validate (--kfold 10) and validate on another recording before deploying.");
}

std::string Correlations(const CalibrationResult& result) {
  constexpr std::size_t kMost = 10;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, result.correlations.size()); ++i) {
    const Correlation& pair = result.correlations[i];
    text += fmt::format("  {:+.3f}  {}, {}\n", pair.coefficient,
                        result.model.parameters[pair.first].name,
                        result.model.parameters[pair.second].name);
  }
  if (result.correlations.size() > kMost) {
    text += fmt::format("  and {} more in summary.json\n", result.correlations.size() - kMost);
  }
  return text.empty() ? "  none\n" : text;
}

}  // namespace

std::string ModelTable(const CalibrationRun& run) {
  const bool folded = run.cross_validation.folds > 0;
  std::vector<std::string> header = {"model", "RMSE 3-D mm", "RMSE coordinate mm", "max mm"};
  if (folded) {
    header.push_back(fmt::format("{}-fold 3-D mm", run.cross_validation.folds));
    header.push_back("max mm");
  }
  TextTable table(header);
  for (ModelKind kind : run.comparison.kinds) {
    const ErrorMetrics& fit = run.comparison.metrics[static_cast<int>(kind)];
    std::vector<std::string> row = {ModelKindName(kind), Millimetres(fit.rmse_3d),
                                    Millimetres(fit.rmse_coordinate), Millimetres(fit.maximum)};
    if (folded) {
      const ErrorMetrics& held_out = run.cross_validation.metrics[static_cast<int>(kind)];
      row.push_back(Millimetres(held_out.rmse_3d));
      row.push_back(Millimetres(held_out.maximum));
    }
    table.Add(row);
  }
  return table.Render();
}

std::string DescribeRun(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  const Excitation& excitation = run.excitation;
  std::string text = fmt::format(
      "{}: {} postures, {} markers, {} equations; {} of {} parameters identifiable (theory {})\n\n",
      result.model.tree.name, run.recording.posture_count(), run.recording.marker_count(),
      result.equations, run.base.geometric_count, result.model.parameter_count(),
      run.base.theoretical_count);
  text += DescribeTrials(run);
  text += ModelTable(run);
  text +=
      run.trials.empty()
          ? "  RMSE is what remains after fitting where the waist and the markers are\n"
          : "  RMSE of markers predicted from the standing foot, or from the waist on two feet\n";
  text += DescribeHeldOut(run);
  text += fmt::format(
      "\n{} model {} after {} iterations, cost {:.4g} -> {:.4g}, {:.1f} ms\n"
      "  noise of a marker coordinate {:.4f} mm; prior widened by {:.2f} (angles) and {:.2f} "
      "(lengths); {:.1f} parameters determined by the data\n\n",
      result.kind == ModelKind::kFull ? "Full" : "Geometric", TerminationName(result.termination),
      result.iterations, result.initial_cost, result.final_cost, 1e3 * result.solve_seconds,
      1e3 * result.marker_sd, result.prior_scale.angles, result.prior_scale.lengths,
      result.posterior.effective_parameters);
  text += ParameterTable(run);
  text += DescribeElasticity(run);
  text += DescribeFeet(run);
  text += "\nNot identifiable with these markers, unchanged in the URDF: " +
          Names(result, WithStatus(result, ParameterStatus::kDropped)) +
          "\nNot supported by the data, held at nominal, not worth deploying: " +
          Names(result, WithStatus(result, ParameterStatus::kUnsupported)) +
          "\nHeld by the project: " + Names(result, WithStatus(result, ParameterStatus::kHeld)) +
          "\n\n";
  text += MarkerText(result);
  text += OutlierText(run);
  text += fmt::format(
      "\nExcitation by this recording: condition number {:.3g} (before the choice of identifiable "
      "parameters {:.3g}); O1 {:.4g}\n"
      "  hardly excited (sd above 1 deg or 5 mm without prior): {}\n",
      excitation.condition_base, excitation.condition_all, excitation.indices.o1,
      Names(result, HardlyExcited(result.model.parameters, run.base.kept, excitation)));
  text += "\nStrong correlations\n" + Correlations(result);
  return text + "\n" + Conclusion(run);
}

}  // namespace elastocal::cli
