// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "elastocal/files/output_set.hpp"
#include "elastocal/report/run_record.hpp"

namespace elastocal {

/// A folder of results holds what each command wrote there last, runs.json with the record of each
/// command, and report.html, the page that shows all of it. A command adds its files in three
/// steps, so that they, the record and the page appear together:
///
///   OutputSet outputs;
///   outputs.Protect(InputFiles(project, recordings));
///   DeclareResults(folder, CalibrationFileNames(project), outputs);
///   outputs.Prepare();
///   ...
///   SetResults(folder, MakeCalibrationFiles(project, run), record, outputs);
///   outputs.Publish();

/// Declares files of these names in the folder, and runs.json, report.html and SHA256SUMS with
/// them. Throws InputError for a file that is there and no result (CheckOwn).
void DeclareResults(const std::filesystem::path& folder, const std::vector<std::string>& names,
                    OutputSet& outputs);

/// Sets the contents of declared files by name, runs.json with this run in it, and report.html from
/// what the folder will hold. Returns why there is no report.html; empty where there is one. Call
/// it once for a folder, after Prepare.
std::string SetResults(const std::filesystem::path& folder,
                       const std::map<std::string, std::string>& files, const RunRecord& record,
                       OutputSet& outputs);

/// The same for the page alone, which may be in the folder or elsewhere.
void DeclarePage(const std::filesystem::path& folder, const std::filesystem::path& page,
                 OutputSet& outputs);
void SetPage(const std::filesystem::path& folder, const std::filesystem::path& page,
             std::string contents, OutputSet& outputs);

/// Declares a JSON file that the user names. Throws InputError where something else than JSON is
/// there, or a result of another command. Call it after DeclareResults.
void DeclareJson(const std::filesystem::path& file, OutputSet& outputs);

/// The page of a folder as it is. Where nothing was calibrated or validated yet and project.yaml is
/// there, it draws the robot as that has it now. `version`: of the program that makes it.
/// `earlier`: folders of earlier calibrations of this robot, or calibration.yaml files, the oldest
/// first.
///
/// Throws InputError where there is nothing to show, or something that cannot be read, and for a
/// folder of two runs (CheckChecksums).
std::string MakeFolderPage(const std::filesystem::path& folder, const std::string& version,
                           const std::vector<std::filesystem::path>& earlier = {});

/// Files of a folder that its page is made from, and those of `earlier`. Throws InputError where
/// there is no such folder, or an earlier one without calibration.yaml.
std::vector<std::filesystem::path> PageInputs(const std::filesystem::path& folder,
                                              const std::vector<std::filesystem::path>& earlier);

/// What to say where the program was built without the page.
extern const char* const kNoPage;

}  // namespace elastocal
