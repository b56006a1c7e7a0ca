// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/cli/commands.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/report/run_record.hpp"

namespace elastocal::cli {

/// Stores the command line for runs.json.
void SetCommandLine(int argc, char** argv);

/// The record of this run for runs.json.
RunRecord MakeRunRecord(const std::string& command, const CommonOptions& options,
                        std::vector<InputRecord> inputs);

/// Prints where the report of a folder is or, if `why_none` is not empty, why there is none.
void PrintReportPlace(const std::filesystem::path& folder, const std::string& why_none, bool quiet);

/// Declares the files that `design` and `plan` write beside their output: robot_data.json,
/// runs.json and report.html.
void DeclarePlanningReport(const std::filesystem::path& output, OutputSet& outputs);

/// Result of SetPlanningReport, to be printed.
struct PlanningReport {
  std::filesystem::path folder;
  std::string why_none;  ///< reason why there is no report.html; empty where there is one
  std::vector<std::string> warnings;
};

/// Sets the contents of these files. Call it after the contents of the command's own files are set.
PlanningReport SetPlanningReport(const std::filesystem::path& output, const RunRecord& record,
                                 const Project& project, OutputSet& outputs);

}  // namespace elastocal::cli
