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

/// Declares files of these names in the folder, with runs.json, report.html and SHA256SUMS. Throws
/// InputError for an existing file that is no result (CheckOwn).
void DeclareResults(const std::filesystem::path& folder, const std::vector<std::string>& names,
                    OutputSet& outputs);

/// Sets the contents of declared files by name (in the calibrated URDF of an input, relative names
/// of meshes lead back to them), of runs.json with this run added, and of
/// report.html for the folder's new state. Returns why there is no report.html; empty where there
/// is one. Call it once for a folder, after Prepare.
std::string SetResults(const std::filesystem::path& folder,
                       const std::map<std::string, std::string>& files, const RunRecord& record,
                       OutputSet& outputs);

/// As DeclareResults and SetResults, for the page alone, which may be in the folder or elsewhere.
void DeclarePage(const std::filesystem::path& folder, const std::filesystem::path& page,
                 OutputSet& outputs);
void SetPage(const std::filesystem::path& folder, const std::filesystem::path& page,
             std::string contents, OutputSet& outputs);

/// Declares a JSON file that the user names. Throws InputError where a file exists there that is no
/// JSON, or is a result of another command. Call it after DeclareResults.
void DeclareJson(const std::filesystem::path& file, OutputSet& outputs);

/// The page of a folder in its present state. Before any calibration or validation, a folder with
/// project.yaml shows the robot of that project. `version` is that of the program. `earlier` holds
/// folders of earlier calibrations of this robot, or their calibration.yaml, the oldest first.
///
/// Throws InputError where there is nothing to show, where something cannot be read, and for a
/// folder with files of two runs (CheckChecksums).
std::string MakeFolderPage(const std::filesystem::path& folder, const std::string& version,
                           const std::vector<std::filesystem::path>& earlier = {});

/// Files from which the page of a folder is made, and those of `earlier`. Throws InputError where
/// the folder does not exist, or an earlier one has no calibration.yaml.
std::vector<std::filesystem::path> PageInputs(const std::filesystem::path& folder,
                                              const std::vector<std::filesystem::path>& earlier);

/// Message where the program was built without the page.
extern const char* const kNoPage;

}  // namespace elastocal
