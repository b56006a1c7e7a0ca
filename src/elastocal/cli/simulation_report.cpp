#include "elastocal/cli/simulation_report.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/text_table.hpp"

namespace elastocal::cli {
namespace {

std::string TrialTable(const std::vector<WrittenTrial>& written,
                       const VirtualExperiment& experiment,
                       const std::vector<std::size_t>& chosen) {
  TextTable table({"trial", "kind", "postures", "frames", "lag s", "waist gives way mm", "deg"});
  for (std::size_t i = 0; i < written.size(); ++i) {
    const PlannedTrial& plan = experiment.trials[chosen[i]];
    table.Add({plan.name, TrialKindName(plan.kind), std::to_string(plan.postures),
               std::to_string(written[i].frames), fmt::format("{:.3f}", written[i].sensors.lag_s),
               fmt::format("{:.2f}", 1e3 * written[i].waist.translation),
               fmt::format("{:.3f}", written[i].waist.rotation * 180.0 / M_PI)});
  }
  return table.Render();
}

std::string StiffnessTable(const VirtualExperiment& experiment) {
  TextTable table(
      {"leg", "Kx N/mm", "Ky N/mm", "Kz N/mm", "Krx N.m/rad", "Kry N.m/rad", "Krz N.m/rad"});
  for (const LegCompliance& leg : experiment.legs) {
    std::vector<std::string> row = {leg.chain};
    for (int i = 0; i < 6; ++i) {
      row.push_back(fmt::format("{:.3g}", leg.compliance.stiffness[i] * (i < 3 ? 1e-3 : 1.0)));
    }
    table.Add(row);
  }
  return table.Render();
}

}  // namespace

std::string DescribeSimulation(const std::vector<WrittenTrial>& written,
                               const VirtualExperiment& experiment,
                               const std::vector<std::size_t>& chosen) {
  return TrialTable(written, experiment, chosen) +
         "\nStiffness of the legs as felt at the waist\n" + StiffnessTable(experiment);
}

std::string MakeSimulationJson(const std::vector<WrittenTrial>& written,
                               const VirtualExperiment& experiment,
                               const std::vector<std::size_t>& chosen) {
  nlohmann::ordered_json json;
  json["trials"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < written.size(); ++i) {
    json["trials"].push_back({{"name", experiment.trials[chosen[i]].name},
                              {"postures", experiment.trials[chosen[i]].postures},
                              {"frames", written[i].frames},
                              {"lag_s", written[i].sensors.lag_s},
                              {"drift_ppm", written[i].sensors.drift_ppm},
                              {"waist_mm", 1e3 * written[i].waist.translation},
                              {"faults", written[i].sensors.faults}});
  }
  for (const LegCompliance& leg : experiment.legs) {
    json["stiffness"][leg.chain] =
        std::vector<double>(leg.compliance.stiffness.begin(), leg.compliance.stiffness.end());
  }
  return json.dump(2) + "\n";
}

}  // namespace elastocal::cli
