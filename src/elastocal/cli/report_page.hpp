#pragma once

#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/io/summary.hpp"
#include "elastocal/report/run_record.hpp"

namespace elastocal::cli {

/// Remembers how the program was called, for runs.json.
void SetCommandLine(int argc, char** argv);

/// Checksums of inputs, on another thread: large recordings are read while the command works.
/// A recording folder stands for the files that its experiment.yaml names.
std::future<std::vector<InputRecord>> StartRecordingInputs(
    const Project& project, const std::vector<std::filesystem::path>& inputs);

/// runs.json of a folder with this run in it.
std::string RunsJson(const std::filesystem::path& folder, const std::string& command,
                     const CommonOptions& options, std::vector<InputRecord> inputs);

/// robot_data.json: what a folder without a calibration needs for the 3-D view.
std::string RobotDataJson(const Project& project);

/// report_data.json of a calibration.
std::string CalibrationDataJson(const Session& session, const CalibrationRun& run);

/// Makes the page of a folder from what is in it; `earlier`: folders of earlier calibrations, or
/// calibration.yaml files. Throws InputError where there is nothing to show or something cannot be
/// read.
std::string MakeFolderPage(const std::filesystem::path& folder,
                           const std::vector<std::string>& earlier = {});

/// What the program says where it was built without the page.
extern const char* const kNoPage;

/// Writes report.html into the folder at the end of another command, and says where it is; says
/// what is lacking where it cannot.
void WriteFolderReport(const std::filesystem::path& folder, bool quiet);

/// The end of `design` and `plan`: beside their output, what the report needs of them and the
/// report itself.
void WritePlanningReport(const std::filesystem::path& output, const std::string& command,
                         const CommonOptions& options, const Project& project,
                         const std::vector<std::filesystem::path>& inputs);

}  // namespace elastocal::cli
