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

/// What a page is made of.
struct ReportSources {
  std::string folder;                             ///< its name, as the user gave it
  std::string version;                            ///< of the program
  std::map<std::string, std::string> files;       ///< texts of ReportFiles, by their names
  std::vector<LabelledCalibration> calibrations;  ///< in the order of time; this folder's one last
  std::vector<std::string> outdated = {};  ///< files that are not shown: of another calibration
};

/// Those of the files of a folder, by name, that a page shows: summary.json, report_data.json,
/// robot_data.json, validation.json, comparison.json, deployment.json, diagnosis.json,
/// runs.json; what design writes (`*_curves.csv`, `*_summary.json`) and plan (motion.csv, or X.csv
/// beside X_margins.json).
std::vector<std::string> ReportFiles(const std::vector<std::string>& names);

/// The data of a page, as docs/formats.md has it under "report.html": everything that the files
/// tell, motions thinned, and what is missing with the command that makes it. Throws InputError
/// naming a file that cannot be read.
std::string MakeReportJson(const ReportSources& sources);

/// The page: the template with these data in it. No text in them can end the script element that
/// holds them.
std::string MakePage(std::string_view page_template, const std::string& json);

/// The template that the program was built with: one HTML file that needs nothing else. Empty where
/// the build had no Node.js.
std::string_view PageTemplate();

}  // namespace elastocal
