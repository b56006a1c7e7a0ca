// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

/// A calibration with the name under which a page shows it.
struct LabelledCalibration {
  std::string label;
  CalibrationEstimate estimate;
};

/// Data from which a page is made.
struct ReportSources {
  std::string folder;                        ///< name of the folder as given by the user
  std::string version;                       ///< version of the program
  std::map<std::string, std::string> files;  ///< contents of ReportFiles, by name
  /// In order of time; that of this folder is the last.
  std::vector<LabelledCalibration> calibrations;
  std::vector<std::string> outdated = {};  ///< files of another calibration, which are not shown
};

/// Those of the given file names whose contents a page shows: summary.json, report_data.json,
/// robot_data.json, validation.json, comparison.json, deployment.json, diagnosis.json, runs.json;
/// files by design (`*_curves.csv`, `*_summary.json`) and by plan (motion.csv, or X.csv beside
/// X_margins.json).
std::vector<std::string> ReportFiles(const std::vector<std::string>& names);

/// The data of a page, described in docs/formats.md under "report.html": everything in the files,
/// with motions thinned, and what is missing, with the command that makes it. Throws InputError
/// that names a file which cannot be read.
std::string MakeReportJson(const ReportSources& sources);

/// The page: the template with these data in it. No text in the data can close the script element
/// that holds them.
std::string MakePage(std::string_view page_template, const std::string& json);

/// The template that the program was built with: one HTML file without dependencies. Empty where
/// the build had no Node.js.
std::string_view PageTemplate();

}  // namespace elastocal
