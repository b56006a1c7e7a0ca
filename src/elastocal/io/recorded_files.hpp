// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/readers/recording_file.hpp"

namespace elastocal {

/// The markers of a trial, from a file of any format.
struct MarkerFile {
  MarkerTrajectories trajectories;
  std::string up;        ///< the axis that the file says points up, "z", "-y"; empty: it does not
  bool up_is_z = false;  ///< the format's custom, unless the user says otherwise (Qualisys TSV)
  std::optional<double> start_s;  ///< of the first frame, on the clock of the file's joint log
};

/// Reads markers: a Qualisys TSV or what ReadRecordingFile knows; contents decide. Labels become
/// names of the project's markers: the label that `recording.labels` gives, or the marker's own
/// name, by itself or behind the name of a subject ("talos:LHAND_1"). Other labels stay as they
/// are. Throws InputError: what the reader refuses, a file without markers, a label that two
/// trajectories have behind different subjects.
MarkerFile ReadMarkerFile(const std::filesystem::path& file, const ReaderOptions& options,
                          const Project& project);

/// Reads a joint log: a CSV (ReadJointLog) or what ReadRecordingFile knows.
JointLog ReadJointFile(const std::filesystem::path& file, const ReaderOptions& options,
                       const Project& project);

/// Reads a file of any of these formats, or the program's own (Qualisys TSV, joint log as CSV), by
/// itself: without a project, under the names of the file. In a CSV, every column but the time
/// (FindTime) is a joint's, unless it is a table of postures or of something else
/// (ReadNamedPostures, ReadColumnsAsTheyAre), of which `postures` tells.
/// RecordingFile::up is "z" for a Qualisys TSV, by custom.
RecordingFile ReadAnyRecording(const std::filesystem::path& file, const ReaderOptions& options);

/// Throws InputError for a file that is a recording over time by its contents (a format of
/// ReadRecordingFile, or a Qualisys TSV), where a table was expected: it says what such a file
/// needs. Does nothing where there is no such file.
void RefuseRecording(const std::filesystem::path& file);

/// A log under the names of a file as one under those of the project: columns renamed, mimic joints
/// and what the project ignores left out, columns of force-torque sensors taken as such. Throws
/// InputError: unknown names (with the nearest known one), positions that look like degrees, a
/// sensor's torques that are absent in some samples.
JointLog TakeJoints(const JointLog& log, const Project& project);

}  // namespace elastocal
