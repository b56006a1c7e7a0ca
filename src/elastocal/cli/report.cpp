// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/report/page.hpp"
#include "elastocal/report/version.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal::cli {
namespace {

struct ReportOptions {
  CommonOptions common;
  std::string folder, output;
  std::vector<std::string> earlier;
};

int Report(const ReportOptions& options) {
  if (PageTemplate().empty()) {
    spdlog::error("{}", kNoPage);
    return kNotConverged;
  }
  const std::filesystem::path folder = options.folder;
  const std::filesystem::path output =
      options.output.empty() ? folder / "report.html" : std::filesystem::path(options.output);
  const std::vector<std::filesystem::path> earlier(options.earlier.begin(), options.earlier.end());
  RecoverOutputs(folder);
  OutputSet outputs;
  outputs.Protect(PageInputs(folder, earlier));
  DeclarePage(folder, output, outputs);
  DeclareJson(options.common.json_file, outputs);
  outputs.Prepare();
  const std::string page = MakeFolderPage(folder, ProgramVersion(), earlier);
  SetPage(folder, output, page, outputs);
  const nlohmann::ordered_json json = {{"report", output.string()}, {"bytes", page.size()}};
  outputs.Set(options.common.json_file, JsonText(json));
  outputs.Publish();
  Print(options.common.Silent() || options.output == "-",
        fmt::format("Report: {} ({:.1f} MB)\n", output.string(),
                    1e-6 * static_cast<double>(page.size())));
  return kFine;
}

}  // namespace

void AddReport(CLI::App& app, Action& action) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* command = app.add_subcommand(
      "report", "One page with all results of a folder: HTML that needs no network");
  command
      ->add_option("folder", options->folder,
                   "Folder that init, design, plan or calibrate wrote to")
      ->required();
  command
      ->add_option("-o,--output", options->output, "The page; default: report.html in the folder")
      ->check(IsNamed)
      ->type_name("FILE");
  command->add_option("--earlier", options->earlier,
                      "Earlier calibrations of this robot, the oldest first: output folders of "
                      "calibrate, or calibration.yaml files");
  AddOutputOptions(*command, options->common);
  command->footer(
      "calibrate -o and validate -o end with this report by themselves. A program that was built\n"
      "without Node.js has no page: it says so and ends with 4.\n"
      "Example: elastocal report out --earlier out_spring -o report.html");
  command->callback([&action, options] { action = [options] { return Report(*options); }; });
}

}  // namespace elastocal::cli
