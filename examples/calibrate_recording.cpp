// Calibrates a robot from what was recorded of it: a posture table, or recording folders.
//
//   calibrate_recording PROJECT.yaml RECORDING...

#include <cstdio>

#include "elastocal/elastocal.hpp"

int main(int argc, char** argv) try {
  if (argc < 3) return 2;
  const elastocal::Project project = elastocal::ReadProject(argv[1]);
  const elastocal::CalibrationRun run =
      elastocal::CalibrateExperiment(project, {argv + 2, argv + argc});
  const auto& uncalibrated =
      run.comparison.metrics[static_cast<int>(elastocal::ModelKind::kUncalibrated)];
  std::printf("from %.2f mm to %.2f mm\n", 1e3 * uncalibrated.rmse_3d,
              1e3 * run.comparison.largest_metrics().rmse_3d);
  for (const std::string& objection : run.verdict.objections) std::puts(objection.c_str());
  return run.deployable() ? 0 : 1;
} catch (const elastocal::InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
