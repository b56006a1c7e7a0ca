#include "elastocal/cli/calibration_report.hpp"

#include <cmath>

#include <fmt/format.h>

#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"

namespace elastocal::cli {
namespace {

std::string Millimetres(double metres) {
  return std::isfinite(metres) ? fmt::format("{:.3f}", 1e3 * metres) : "-";
}

std::string ParameterTable(const CalibrationResult& result) {
  TextTable table({"parameter", "unit", "estimate", "sd", "95 % interval", ""});
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (result.status[i] != ParameterStatus::kEstimated || parameter.joint < 0) continue;
    const double value = InUserUnits(parameter, result.delta[i]);
    const double sd = InUserUnits(parameter, result.sd[i]);
    const double half = result.interval_factor * sd;
    table.Add({parameter.name, UserUnit(parameter), fmt::format("{:.4f}", value),
               fmt::format("{:.4f}", sd),
               fmt::format("[{:.4f}, {:.4f}]", value - half, value + half),
               Significant(result, i) ? "*" : ""});
  }
  return table.Render() + "  * differs from nominal at 95 %\n";
}

std::string WithStatus(const CalibrationResult& result, ParameterStatus status) {
  std::vector<int> which;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    if (result.status[i] == status) which.push_back(i);
  }
  return which.empty() ? "none" : JoinNames(result.model.parameters, which);
}

std::string OutlierText(const CalibrationRun& run) {
  const auto& outliers = run.comparison.geometric().outliers;
  if (outliers.empty()) return "Outliers: none\n";
  std::string text = "Outliers (left out of the fit)\n";
  for (const Outlier& outlier : outliers) {
    text += fmt::format("  {}: off by {:.3f} mm, {:.1f} times what is likely\n",
                        DescribeObservation(run.recording, outlier.posture, outlier.marker),
                        1e3 * outlier.residual, outlier.normalised);
  }
  return text;
}

/// Parameters whose uncertainty from this recording alone is larger than what the prior says.
std::string WeaklyExcited(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.geometric();
  std::vector<int> weak;
  for (std::size_t i = 0; i < run.base.kept.size(); ++i) {
    const Parameter& parameter = result.model.parameters[run.base.kept[i]];
    const double limit = parameter.unit == ParameterUnit::kRadian ? M_PI / 180.0 : 5e-3;
    if (run.excitation.parameter_sd[static_cast<Eigen::Index>(i)] > limit) {
      weak.push_back(run.base.kept[i]);
    }
  }
  return weak.empty() ? "none" : JoinNames(result.model.parameters, weak);
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
  for (ModelKind kind : kModelKinds) {
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
  const CalibrationResult& result = run.comparison.geometric();
  const Excitation& excitation = run.excitation;
  std::string text = fmt::format(
      "{}: {} postures, {} markers, {} equations; {} of {} parameters identifiable (theory {})\n\n",
      result.model.tree.name, run.recording.posture_count(), run.recording.marker_count(),
      result.equations, run.base.kept.size(), result.model.parameter_count(),
      run.base.theoretical_count);
  text += ModelTable(run);
  text += fmt::format(
      "\nGeometric model {} after {} iterations, cost {:.4g} -> {:.4g}, {:.1f} ms\n"
      "  noise of a marker coordinate {:.4f} mm; prior widened by {:.2f} (angles) and {:.2f} "
      "(lengths); {:.1f} parameters determined by the data\n\n",
      TerminationName(result.termination), result.iterations, result.initial_cost,
      result.final_cost, 1e3 * result.solve_seconds, 1e3 * result.marker_sd, result.prior_scale.angles, result.prior_scale.lengths,
      result.posterior.effective_parameters);
  text += ParameterTable(result);
  text += "\nNot supported by the data, held at nominal, not worth deploying: " +
          WithStatus(result, ParameterStatus::kUnsupported) + "\n";
  text += "Held by the project: " + WithStatus(result, ParameterStatus::kHeld) + "\n\n";
  text += OutlierText(run);
  text += fmt::format(
      "\nExcitation by this recording: condition number {:.3g} of all columns, {:.3g} of the "
      "identifiable ones; O1 {:.4g}\n"
      "  hardly excited (sd above 1 deg or 5 mm without prior): {}\n",
      excitation.condition_all, excitation.condition_base, excitation.indices.o1,
      WeaklyExcited(run));
  text += "\nStrong correlations\n" + Correlations(result);
  return text;
}

}  // namespace elastocal::cli
