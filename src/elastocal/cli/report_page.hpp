#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/cli/commands.hpp"
#include "elastocal/io/project.hpp"
#include "elastocal/report/run_record.hpp"

namespace elastocal::cli {

/// Remembers how the program was called, for runs.json.
void SetCommandLine(int argc, char** argv);

/// The record of this run for runs.json.
RunRecord MakeRunRecord(const std::string& command, const CommonOptions& options,
                        std::vector<InputRecord> inputs);

/// Says where the report of a folder is or, where that is not empty, why there is none.
void PrintReportPlace(const std::filesystem::path& folder, const std::string& why_none, bool quiet);

/// The end of `design` and `plan`: beside their output, what the report needs of them and the
/// report itself.
void WritePlanningReport(const std::filesystem::path& output, const std::string& command,
                         const CommonOptions& options, const Project& project,
                         const std::vector<std::filesystem::path>& inputs);

}  // namespace elastocal::cli
