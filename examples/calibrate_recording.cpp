// SPDX-License-Identifier: Apache-2.0
// Calibrates a robot from its recording: a posture table, or recording folders.
//
//   calibrate_recording PROJECT.yaml RECORDING...

#include <cstdio>

#include "elastocal/elastocal.hpp"

int main(int argc, char** argv) try {
  if (argc < 3) return 2;
  const elastocal::Project project = elastocal::ReadProject(argv[1]);
  const elastocal::CalibrationRun run =
      elastocal::CalibrateExperiment(project, {argv + 2, argv + argc});
  const auto rmse_mm = [&](elastocal::ModelKind kind) {
    return 1e3 * run.comparison.metrics[static_cast<int>(kind)].rmse_3d;
  };
  std::printf("from %.2f mm to %.2f mm\n", rmse_mm(elastocal::ModelKind::kUncalibrated),
              rmse_mm(run.deployment.urdf_kind));
  for (const std::string& objection : run.verdict.objections) std::puts(objection.c_str());
  return run.deployable() ? 0 : 1;
} catch (const elastocal::InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
