// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/report_page.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/session.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/pipeline/robot_views.hpp"
#include "elastocal/report/page.hpp"
#include "elastocal/report/version.hpp"

namespace elastocal::cli {
namespace {

namespace fs = std::filesystem;

std::vector<std::string>& CommandLine() {
  static std::vector<std::string> words;
  return words;
}

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

void SetCommandLine(int argc, char** argv) {
  CommandLine().assign(argv, argv + argc);
  if (argc > 0) CommandLine()[0] = "elastocal";
}

RunRecord MakeRunRecord(const std::string& command, const CommonOptions& options,
                        std::vector<InputRecord> inputs) {
  std::error_code unknown;  // a folder that was removed
  return {command,           QuoteCommandLine(CommandLine()),   ProgramVersion(), options.seed,
          std::move(inputs), fs::current_path(unknown).string()};
}

void PrintReportPlace(const fs::path& folder, const std::string& why_none, bool quiet) {
  if (why_none.empty()) {
    Print(quiet, fmt::format("Report: {}\n", (folder / "report.html").string()));
  } else if (PageTemplate().empty()) {
    Print(quiet, why_none + "\n");
  } else {
    spdlog::warn("{}", why_none);
  }
}

void DeclarePlanningReport(const fs::path& output, OutputSet& outputs) {
  DeclareResults(FolderOf(output), {"robot_data.json"}, outputs);
}

PlanningReport SetPlanningReport(const fs::path& output, const RunRecord& record,
                                 const Project& project, OutputSet& outputs) {
  PlanningReport report{FolderOf(output), {}, {}};
  const std::string robot = MakeRobotDataJson(MakeRobotView(project, report.warnings));
  report.why_none = SetResults(report.folder, {{"robot_data.json", robot}}, record, outputs);
  return report;
}

}  // namespace elastocal::cli
