// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/simulation_report.hpp"

#include <cmath>

#include <fmt/format.h>

#include "elastocal/cli/text_table.hpp"

namespace elastocal::cli {
namespace {

std::string TrialTable(const std::vector<TrialOutcome>& trials) {
  TextTable table({"trial", "kind", "postures", "frames", "lag s", "waist gives way mm", "deg"});
  for (const TrialOutcome& trial : trials) {
    table.Add({trial.name, TrialKindName(trial.kind), std::to_string(trial.postures),
               std::to_string(trial.frames), fmt::format("{:.3f}", trial.sensors.lag_s),
               fmt::format("{:.2f}", 1e3 * trial.waist.translation),
               fmt::format("{:.3f}", trial.waist.rotation * 180.0 / M_PI)});
  }
  return table.Render();
}

std::string StiffnessTable(const std::vector<LegCompliance>& legs) {
  TextTable table(
      {"leg", "Kx N/mm", "Ky N/mm", "Kz N/mm", "Krx N.m/rad", "Kry N.m/rad", "Krz N.m/rad"});
  for (const LegCompliance& leg : legs) {
    std::vector<std::string> row = {leg.chain};
    for (int i = 0; i < 6; ++i) {
      row.push_back(fmt::format("{:.3g}", leg.compliance.stiffness[i] * (i < 3 ? 1e-3 : 1.0)));
    }
    table.Add(row);
  }
  return table.Render();
}

}  // namespace

std::string DescribeSimulation(const SimulationRun& run) {
  if (run.legs.empty()) return TrialTable(run.trials);
  return TrialTable(run.trials) + "\nStiffness of the legs as felt at the waist\n" +
         StiffnessTable(run.legs);
}

std::string WrittenRecording(const std::string& folder) {
  return fmt::format("\nWritten: {} with experiment.yaml and truth.yaml\n", folder);
}

}  // namespace elastocal::cli
