#pragma once

#include <string>
#include <vector>

#include "elastocal/io/experiment.hpp"
#include "elastocal/simulation/virtual_experiment.hpp"

namespace elastocal::cli {

/// What is kept of a trial once its files are written.
struct WrittenTrial {
  TrialFiles files;
  SensorTruth sensors;
  int frames = 0;
  WaistGive waist;
};

/// Tables of the trials and of the legs' stiffness. `chosen`: which of the experiment's trials
/// `written` are.
std::string DescribeSimulation(const std::vector<WrittenTrial>& written,
                               const VirtualExperiment& experiment,
                               const std::vector<std::size_t>& chosen);

/// The same for programs (JSON).
std::string MakeSimulationJson(const std::vector<WrittenTrial>& written,
                               const VirtualExperiment& experiment,
                               const std::vector<std::size_t>& chosen);

}  // namespace elastocal::cli
