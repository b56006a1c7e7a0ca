// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/report/run_record.hpp"

namespace elastocal {

/// A calibration together with the project that it was made with.
struct CalibratedRobot {
  Project project;
  StoredCalibration calibration;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
};

/// Opens the folder that calibrate wrote to, or its calibration.yaml. The project is that of the
/// record of the calibration (runs.json beside it), unless `project` names another place of it.
/// Throws InputError: no record, or it names no project; a project that cannot be read or has
/// changed since (by its checksum), unless it was named; what FindCalibrationFiles throws.
CalibratedRobot OpenCalibratedRobot(const std::filesystem::path& given,
                                    const std::filesystem::path& project = {});

/// The recordings that the calibration was made from, as runs.json beside it names them: tables, or
/// folders of trials. Throws InputError where there is no such record, or a recording is not there
/// or has changed since (by its checksum).
std::vector<std::filesystem::path> RecordedRecordings(const CalibratedRobot& robot);

/// What calibrate was told beside the recordings, by runs.json. Empty for a record of an earlier
/// version, which did not store it.
Assumptions RecordedAssumptions(const CalibratedRobot& robot);

/// All inputs that the record of the calibration names, whether or not the files still exist; empty
/// without a readable record. No output may replace these files.
std::vector<std::filesystem::path> RecordedFiles(const CalibratedRobot& robot);

/// Whether the calibration (its calibration.yaml) was made from one of these files, as the record
/// beside it has their checksums; files that describe the robot and experiments do not count. False
/// where there is no record.
bool IsOwnRecording(const std::filesystem::path& calibration,
                    const std::vector<std::filesystem::path>& files);

/// The same; if it was, adds a warning.
bool WarnOfOwnRecording(const std::filesystem::path& calibration,
                        const std::vector<std::filesystem::path>& files,
                        std::vector<std::string>& warnings);

}  // namespace elastocal
