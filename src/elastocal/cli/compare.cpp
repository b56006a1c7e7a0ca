// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/comparison_report.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/pipeline/compare_calibrations.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal::cli {
namespace {

struct CompareOptions {
  CommonOptions common;
  std::string a, b;
  ComparisonOptions comparison;
};

int Compare(const CompareOptions& options) {
  OutputSet outputs;
  for (const std::string& given : {options.a, options.b}) {
    const CalibrationFiles files = FindCalibrationFiles(given);
    outputs.Protect({files.calibration, files.covariance});
  }
  DeclareJson(options.common.json_file, outputs);
  outputs.Prepare();
  const ComparisonRun run = CompareCalibrations(options.a, options.b, options.comparison);
  nlohmann::ordered_json json =
      MakeComparisonJson(run.a, run.b, run.comparison, options.comparison);
  json["soles"] = SoleDifferencesJson(run.soles);
  outputs.Set(options.common.json_file, JsonText(json));
  outputs.Publish();
  Print(options.common.Silent(), DescribeComparison(run.a, run.b, run.comparison,
                                                    options.comparison, options.common.verbose) +
                                     DescribeSoleChanges(run.soles));
  PrintWarnings(run.comparison.warnings, options.common.verbose);
  return kFine;
}

}  // namespace

void AddCompare(CLI::App& app, Action& action) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand(
      "compare", "Compare two calibrations of one robot: which joints moved, and by how much");
  const std::string what = "output folder of calibrate, or a calibration.yaml";
  command->add_option("A", options->a, "The earlier calibration: " + what)->required();
  command->add_option("B", options->b, "The later one: " + what)->required();
  command
      ->add_option("--level", options->comparison.level,
                   "Chance that any joint of an unchanged robot is called moved all the same")
      ->check(InBounds("compare --level"))
      ->capture_default_str();
  command->add_flag("--new-markers", options->comparison.new_markers,
                    "Markers were taken off in between: conclude nothing from their places");
  AddOutputOptions(*command, options->common);
  command->footer(
      "Ends with 0 whether joints moved or not; the JSON's status tells.\n"
      "Example: elastocal compare out_spring out_autumn");
  command->callback([&action, options] { action = [options] { return Compare(*options); }; });
}

}  // namespace elastocal::cli
