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

/// Remembers how the program was called, for runs.json.
void SetCommandLine(int argc, char** argv);

/// The record of this run for runs.json.
RunRecord MakeRunRecord(const std::string& command, const CommonOptions& options,
                        std::vector<InputRecord> inputs);

/// Says where the report of a folder is or, where that is not empty, why there is none.
void PrintReportPlace(const std::filesystem::path& folder, const std::string& why_none, bool quiet);

/// What `design` and `plan` write beside their output (robot_data.json, runs.json and report.html),
/// declared together with it.
void DeclarePlanningReport(const std::filesystem::path& output, OutputSet& outputs);

/// What to say of it.
struct PlanningReport {
  std::filesystem::path folder;
  std::string why_none;  ///< why there is no report.html; empty where there is one
  std::vector<std::string> warnings;
};

/// The contents of these files. Call it when those of the command itself are set.
PlanningReport SetPlanningReport(const std::filesystem::path& output, const RunRecord& record,
                                 const Project& project, OutputSet& outputs);

}  // namespace elastocal::cli
