// SPDX-License-Identifier: Apache-2.0
// The library in C++: draws a robot with errors, records it, and estimates the errors.
//
//   simulate_and_calibrate models/talos/project.yaml LHAND
//
// uses the markers of the project whose names begin with LHAND.

#include <cmath>
#include <cstdio>
#include <exception>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"

using namespace elastocal;

namespace {

int Run(const char* project_file, const char* prefix) {
  const Project project = ReadProject(project_file);
  std::vector<std::string> names;
  for (const Marker& marker : project.markers) {
    if (marker.name.starts_with(prefix)) names.push_back(marker.name);
  }
  const ErrorModel model =
      SelectMarkers(MakeErrorModel(project.tree, project.markers, project.placement), names);
  const BaseParameters base = FindBaseParameters(model, project.identifiability);

  const Eigen::VectorXd truth =
      DrawErrors(model, base.kept, {{ParameterKind::kTheta, 0.01}, {ParameterKind::kD, 1e-3}}, 1);
  const Recording recording = MakeSyntheticRecording(model, truth, {.postures = 50});
  const CalibrationResult result =
      Calibrate(model, recording, base, ModelKind::kGeometric, project.calibration);

  std::printf("%s, noise %.3f mm\n", TerminationName(result.termination), 1e3 * result.marker_sd);
  for (int i : base.kept) {
    if (model.parameters[i].kind != ParameterKind::kTheta) continue;
    std::printf("%-26s true %8.5f  estimated %8.5f +- %.5f rad\n", model.parameters[i].name.c_str(),
                truth[i], result.delta[i], result.interval_factor * result.sd[i]);
  }
  return result.termination == Termination::kConverged ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return argc == 3 ? Run(argv[1], argv[2]) : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
