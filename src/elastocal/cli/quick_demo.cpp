// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/quick_demo.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "elastocal/cli/calibration_run.hpp"
#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/planning/known_truth.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"

namespace elastocal::cli {
namespace {

std::string TruthTable(const std::vector<FoundParameter>& found) {
  TextTable table({"parameter", "unit", "truth", "estimate", "sd", "error / sd"});
  int inside = 0;
  for (const auto& [parameter, truth, estimate, sd, is_inside] : found) {
    inside += is_inside ? 1 : 0;
    const double user_sd = InUserUnits(parameter, sd);
    table.Add({parameter.name, UserUnit(parameter),
               RoundedTo(InUserUnits(parameter, truth), user_sd),
               RoundedTo(InUserUnits(parameter, estimate), user_sd), RoundedSd(user_sd),
               fmt::format("{:+.2f}", (estimate - truth) / sd)});
  }
  return "\nTruth against estimate\n" + table.Render() +
         fmt::format("  {} of {} joint parameters lie within their 95 % interval\n", inside,
                     found.size());
}

}  // namespace

int QuickDemo(const QuickDemoOptions& options) {
  const std::filesystem::path& source = options.project;
  const std::filesystem::path& folder = options.output;
  const Project project = ReadProject(source);
  const std::uint64_t seed = options.common.seed.value_or(1);
  const KnownTruth truth = DrawUpperBodyErrors(project, seed);
  const Recording recording = MakeSyntheticRecording(
      truth.model, truth.delta, {.postures = options.postures, .seed = seed + 1});
  WritePostureTable(folder / "recording.csv", recording, project);
  Print(
      options.common.Silent(),
      fmt::format("A TALOS with known errors, {} random postures of its upper body, 0.2 mm marker "
                  "noise: {}\n\n",
                  options.postures, (folder / "recording.csv").string()));

  CalibrateOptions calibrate;
  calibrate.common = options.common;
  calibrate.project = source.string();
  calibrate.output = folder.string();
  calibrate.recordings = {(folder / "recording.csv").string()};
  calibrate.folds = std::min(5, options.postures);
  CalibrationRun run;
  const int exit_code = RunCalibration(calibrate, &run);
  Print(options.common.Silent(), TruthTable(CompareWithTruth(truth, run.comparison.largest())));
  return exit_code;
}

}  // namespace elastocal::cli
