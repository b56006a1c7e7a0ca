// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/diagnose.hpp"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/pipeline/result_folder.hpp"

namespace elastocal::cli {
namespace {

constexpr std::size_t kShown = 12;

struct DiagnoseOptions {
  CommonOptions common;
  std::string calibration, project;
};

std::string CauseTable(const CauseReport& report, bool all) {
  const std::string unit = report.error_unit();
  TextTable table({"cause", "score", "p adjusted", "held-out gain " + unit, "mean gain " + unit});
  std::size_t shown = 0;
  for (const CauseFinding& finding : report.search.findings) {
    if (!all && ++shown > kShown) break;
    const double factor = report.error_factor();
    table.Add(
        {finding.cause, fmt::format("{:.1f}", finding.score),
         fmt::format("{:.2g}", finding.p_adjusted), fmt::format("{:.2g}", factor * finding.gain),
         fmt::format("{:.2g} +- {:.2g}", factor * finding.mean_gain, factor * finding.gain_sd)});
  }
  return table.Render();
}

int RunDiagnosis(const DiagnoseOptions& options) {
  OutputSet outputs;
  DeclareJson(options.common.json_file, outputs);
  outputs.Prepare();
  const Diagnosis diagnosis = Diagnose(options.calibration, options.project, options.common.seed);
  outputs.Set(options.common.json_file, MakeDiagnosisJson(diagnosis));
  outputs.Publish();
  const bool quiet = options.common.Silent();
  Print(quiet, fmt::format("{}: {} postures, {} causes tested in {:.1f} s\n\n", diagnosis.recording,
                           diagnosis.report.postures, diagnosis.report.search.findings.size(),
                           diagnosis.seconds));
  for (const std::string& sentence : DescribeDiagnosis(diagnosis.report)) {
    Print(quiet, sentence + "\n");
  }
  Print(quiet, "\n" + CauseTable(diagnosis.report, options.common.verbose));
  PrintWarnings(diagnosis.warnings);
  return kFine;
}

}  // namespace

void AddDiagnose(CLI::App& app, Action& action) {
  auto options = std::make_shared<DiagnoseOptions>();
  CLI::App* command = app.add_subcommand(
      "diagnose", "Say what geometry and springs leave unexplained, and why (docs/diagnose.md)");
  AddCalibratedRobot(*command, options->calibration, options->project);
  AddCommonOptions(*command, options->common);
  command->footer("Example: elastocal diagnose out --json diagnosis.json");
  command->callback([&action, options] { action = [options] { return RunDiagnosis(*options); }; });
}

}  // namespace elastocal::cli
