#include "elastocal/cli/report_page.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/session.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/pipeline/robot_views.hpp"
#include "elastocal/report/page.hpp"

namespace elastocal::cli {
namespace {

namespace fs = std::filesystem;

std::vector<std::string>& CommandLine() {
  static std::vector<std::string> words;
  return words;
}

}  // namespace

void SetCommandLine(int argc, char** argv) {
  CommandLine().assign(argv, argv + argc);
  if (argc > 0) CommandLine()[0] = "elastocal";
}

RunRecord MakeRunRecord(const std::string& command, const CommonOptions& options,
                        std::vector<InputRecord> inputs) {
  return {command, QuoteCommandLine(CommandLine()), ELASTOCAL_VERSION, options.seed,
          std::move(inputs)};
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

void WritePlanningReport(const fs::path& output, const std::string& command,
                         const CommonOptions& options, const Project& project,
                         const std::vector<fs::path>& inputs) {
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  std::vector<fs::path> files = {project.file, project.urdf};
  files.insert(files.end(), inputs.begin(), inputs.end());
  OutputSet outputs;
  outputs.Protect(files);
  DeclareResults(folder, {"robot_data.json"}, outputs);
  outputs.Prepare();
  std::vector<std::string> warnings;
  const std::string robot = MakeRobotDataJson(MakeRobotView(project, warnings));
  const std::string why_none =
      SetResults(folder, {{"robot_data.json", robot}},
                 MakeRunRecord(command, options, RecordInputs(files)), outputs);
  outputs.Publish();
  PrintWarnings(warnings);
  PrintReportPlace(folder, why_none, options.Silent());
}

}  // namespace elastocal::cli
