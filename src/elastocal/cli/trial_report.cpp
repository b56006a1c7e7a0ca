// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/trial_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "elastocal/calibration/leg_stiffness.hpp"
#include "elastocal/cli/error_table_report.hpp"
#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/measurement/describe_posture.hpp"

namespace elastocal::cli {
namespace {

std::string Stiffness(double compliance, const char* unit, double factor) {
  if (!(compliance > 0.0)) return "rigid";
  return fmt::format("{:.3g} {}", factor / compliance, unit);
}

/// Stiffness as text: N/mm along an axis, N.m/rad about one.
std::string StiffnessOf(const Parameter& parameter, double compliance) {
  const bool linear = parameter.unit == ParameterUnit::kMetrePerNewton;
  return Stiffness(compliance, linear ? "N/mm" : "N.m/rad", linear ? 1e-3 : 1.0);
}

/// Text on how much the recording adds to the prior.
std::string LittleTold(const CalibrationResult& result, int i) {
  const Parameter& parameter = result.model.parameters[i];
  const auto figure = [&](double value) {
    return fmt::format("{:.2g}", InUserUnits(parameter, value));
  };
  return fmt::format("  {}: {} +- {} {}, beforehand +- {}\n", parameter.name,
                     figure(result.delta[i]), figure(result.sd[i]), UserUnit(parameter),
                     figure(result.prior_sd[i]));
}

/// Text on the stiffness of the legs at the waist; empty for a robot without legs.
std::string DescribeLegs(const std::vector<LegStiffness>& legs) {
  if (legs.empty()) return "";
  TextTable table({"leg at the waist (95 %)", "Kx N/mm", "Ky", "Kz", "Krx N.m/rad", "Kry", "Krz"});
  for (const LegStiffness& leg : legs) {
    std::vector<std::string> row = {leg.leg};
    for (int axis = 0; axis < 6; ++axis) {
      const double unit = axis < 3 ? 1e-3 : 1.0;
      row.push_back(leg.known(axis)
                        ? fmt::format("{:.3g} ({:.3g}-{:.3g})", unit * leg.stiffness[axis],
                                      unit * leg.low[axis], unit * leg.high[axis])
                        : fmt::format("unknown (> {:.3g})", unit * leg.low[axis]));
    }
    table.Add(row);
  }
  return table.Render();
}

/// Text on the compliance below the markers of the feet; empty for a robot without legs.
std::string DescribeSoles(const std::vector<SoleSpring>& soles) {
  std::string text;
  bool open = false;
  for (const SoleSpring& sole : soles) {
    open = open || !sole.told();
    if (!std::isfinite(sole.sd)) {
      text += fmt::format("  {}: not told\n", sole.leg);
    } else if (!sole.told()) {
      text += fmt::format("  {}: not told, at most {:.2f} um/N\n", sole.leg, 1e6 * sole.most());
    } else {
      text += fmt::format("  {}: {:.2f} um/N (sd {:.2f}; the load changed {} times)\n", sole.leg,
                          1e6 * sole.compliance, 1e6 * sole.sd, sole.changes);
    }
  }
  if (open) {
    text +=
        "  It shows where a foot stays and its load changes: record a trial on one foot right\n"
        "  before or after one on both, with the torques of both legs, without setting that foot\n"
        "  down anew.\n";
  }
  return text.empty() ? "" : "\nSpring between the markers of a foot and the floor\n" + text;
}

}  // namespace

std::string DescribeTrials(const CalibrationRun& run) {
  if (run.trials.empty()) return "";
  std::string text = "Trials\n";
  for (const TrialSummary& trial : run.trials) text += "  " + Describe(trial) + "\n";
  return text + "\n";
}

std::string DescribeElasticity(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  if (result.kind != ModelKind::kFull) return "";
  TextTable table({"compliance", "unit", "estimate", "sd", "stiffness", "95 % interval"});
  std::string unsupported;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (!IsCompliance(parameter.kind)) continue;
    if (result.status[i] == ParameterStatus::kUnsupported) {
      unsupported += LittleTold(result, i);
    }
    if (result.status[i] != ParameterStatus::kEstimated) continue;
    const double half = result.interval_factor * result.sd[i];
    const double sd = InUserUnits(parameter, result.sd[i]);
    table.Add({parameter.name, UserUnit(parameter),
               RoundedTo(InUserUnits(parameter, result.delta[i]), sd), RoundedSd(sd),
               StiffnessOf(parameter, result.delta[i]),
               fmt::format("{} to {}", StiffnessOf(parameter, result.delta[i] + half),
                           StiffnessOf(parameter, result.delta[i] - half))});
  }
  return "\nElasticity\n" + table.Render() + DescribeLegs(AssessLegs(result, run.recording)) +
         (unsupported.empty() ? ""
                              : "Compliances of which this recording tells hardly more than was "
                                "assumed (one sd):\n" +
                                    unsupported) +
         DescribeSoles(run.soles);
}

std::string DescribeFeet(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  std::string text;
  for (const Slip& slip : result.slips) {
    const std::string what =
        slip.leg < 0 ? "root link" : "foot of " + result.model.legs[slip.leg].name;
    text += fmt::format("  {} slipped by {:.1f} mm before {}\n", what, 1e3 * slip.distance,
                        DescribePosture(run.recording, slip.posture));
  }
  for (const LooseFooting& footing : result.loose_footings) {
    text += fmt::format("  {}: the waist is {:.1f} mm from where its leg puts it, left out\n",
                        DescribePosture(run.recording, footing.posture), 1e3 * footing.distance);
  }
  return text.empty() ? "" : "\nSupporting feet\n" + text;
}

std::string DescribeHeldOut(const CalibrationRun& run) {
  if (!run.held_out) return "";
  std::string text = "\nHeld-out motions (Table 2), mm\n" + DescribeErrorTable(run.held_out->table);
  for (ModelKind kind : run.comparison.kinds) {
    const double error = run.waist_error[static_cast<int>(kind)];
    if (!std::isfinite(error)) continue;
    text += fmt::format("  waist on one foot, {} model: {:.2f} mm from the truth\n",
                        ModelKindName(kind), 1e3 * error);
  }
  return text;
}

}  // namespace elastocal::cli
