// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/report/run_record.hpp"

namespace elastocal {

/// A calibration with the project for which it was made.
struct CalibratedRobot {
  Project project;
  StoredCalibration calibration;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
};

/// Opens a calibration: the folder that calibrate wrote to, or its calibration.yaml. The project is
/// the one that the record of the calibration (runs.json beside it) names, unless `project` gives
/// another path. Throws InputError if there is no record or it names no project, if the project
/// cannot be read or has changed since (by its checksum; not where `project` is given), and as
/// FindCalibrationFiles.
CalibratedRobot OpenCalibratedRobot(const std::filesystem::path& given,
                                    const std::filesystem::path& project = {});

/// The recordings from which the calibration was made, as runs.json beside it names them: tables,
/// or folders of trials. Throws InputError where there is no such record, or where a recording is
/// missing or has changed since (by its checksum).
std::vector<std::filesystem::path> RecordedRecordings(const CalibratedRobot& robot);

/// Assumptions that calibrate was given beside the recordings, from runs.json. Empty for a record
/// of an earlier version, which did not store them.
Assumptions RecordedAssumptions(const CalibratedRobot& robot);

/// All inputs that the record of the calibration names, whether or not the files still exist; empty
/// without a readable record. No output may replace these files.
std::vector<std::filesystem::path> RecordedFiles(const CalibratedRobot& robot);

/// Whether the calibration (its calibration.yaml) was made from one of these files, by the
/// checksums in the record beside it. Files that describe the robot and experiments do not count.
/// False where there is no record.
bool IsOwnRecording(const std::filesystem::path& calibration,
                    const std::vector<std::filesystem::path>& files);

/// As IsOwnRecording; if true, adds a warning.
bool WarnOfOwnRecording(const std::filesystem::path& calibration,
                        const std::vector<std::filesystem::path>& files,
                        std::vector<std::string>& warnings);

}  // namespace elastocal
