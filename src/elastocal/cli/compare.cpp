#include <cmath>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/comparison_report.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal::cli {
namespace {

struct CompareOptions {
  CommonOptions common;
  std::string a, b;
  ComparisonOptions comparison;
};

struct CalibrationFiles {
  std::filesystem::path calibration, covariance;
};

/// Of an output folder of calibrate, or of a calibration.yaml.
CalibrationFiles FilesOf(const std::string& given) {
  const std::filesystem::path path = given;
  if (!std::filesystem::is_directory(path)) return {path, path.parent_path() / "covariance.csv"};
  const CalibrationFiles files{path / "calibration.yaml", path / "covariance.csv"};
  if (!std::filesystem::exists(files.calibration)) {
    throw InputError(given + ": no calibration.yaml in this folder; expected the folder that " +
                     "calibrate wrote a result to that can be deployed");
  }
  return files;
}

CalibrationEstimate ReadBoth(const CalibrationFiles& files) {
  CalibrationEstimate estimate = ReadEstimate(files.calibration);
  if (std::filesystem::exists(files.covariance)) ReadCovariance(files.covariance, estimate);
  return estimate;
}

int Compare(const CompareOptions& options) {
  const CalibrationFiles files_a = FilesOf(options.a);
  const CalibrationFiles files_b = FilesOf(options.b);
  CheckOutputs({options.common.json_file},
               {files_a.calibration, files_a.covariance, files_b.calibration, files_b.covariance});
  const CalibrationEstimate a = ReadBoth(files_a);
  const CalibrationEstimate b = ReadBoth(files_b);
  const CalibrationComparison comparison = CompareCalibrations(a, b, options.comparison);
  Print(options.common.Silent(), DescribeComparison(a, b, comparison, options.comparison));
  PrintWarnings(comparison.warnings);
  if (!options.common.json_file.empty()) {
    WriteFile(options.common.json_file,
              MakeComparisonJson(a, b, comparison, options.comparison).dump(2) + "\n");
  }
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
      ->check(CLI::Range(1e-9, 0.5))
      ->capture_default_str();
  AddCommonOptions(*command, options->common);
  command->footer(
      "Ends with 0 whether joints moved or not; the JSON's status tells.\n"
      "Example: elastocal compare out_spring out_autumn");
  command->callback([&action, options] { action = [options] { return Compare(*options); }; });
}

}  // namespace elastocal::cli
