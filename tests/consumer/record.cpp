// SPDX-License-Identifier: Apache-2.0
// Writes a recording of a project's robot with errors, as an example of the component planning:
//   record PROJECT.yaml RECORDING.csv

#include "elastocal/elastocal.hpp"
#include "elastocal/planning.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const elastocal::Project project = elastocal::ReadProject(argv[1]);
  const elastocal::ErrorModel model =
      elastocal::MakeErrorModel(project.tree, project.markers, project.placement);
  const elastocal::BaseParameters base =
      elastocal::FindBaseParameters(model, project.identifiability);
  const Eigen::VectorXd truth =
      elastocal::DrawErrors(model, base.kept, {{elastocal::ParameterKind::kTheta, 0.01}}, 1);
  elastocal::WritePostureTable(
      argv[2], elastocal::MakeSyntheticRecording(model, truth, {.postures = 30}), project.tree);
}
