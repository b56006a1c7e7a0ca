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
  bool up_is_z = false;  ///< z points up by custom of the format (Qualisys TSV)
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

/// Reads a file of any of these formats, or of the program's own (Qualisys TSV, joint log as CSV),
/// without a project and under the names of the file. A CSV that is a table of postures or of
/// something else (ReadNamedPostures, ReadColumnsAsTheyAre) is described by
/// RecordingFile::postures. In any other CSV, every column but the time (FindTime) is that of a
/// joint. RecordingFile::up is "z" for a Qualisys TSV, by custom.
RecordingFile ReadAnyRecording(const std::filesystem::path& file, const ReaderOptions& options);

/// Throws InputError for a file where a table was expected, if it is a recording over time by its
/// contents (a format of ReadRecordingFile, or a Qualisys TSV). The message says what such a file
/// needs. Does nothing if the file does not exist.
void RefuseRecording(const std::filesystem::path& file);

/// Turns a log under the names of a file into one under the names of the project. It renames
/// columns, leaves out mimic joints and what the project ignores, and takes the columns of
/// force-torque sensors as wrenches. Throws InputError: unknown names (with the nearest known one),
/// positions that look like degrees, a sensor's torques that are absent in some samples.
JointLog TakeJoints(const JointLog& log, const Project& project);

}  // namespace elastocal
