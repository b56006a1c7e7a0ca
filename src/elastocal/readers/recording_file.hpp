// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/readers/byte_source.hpp"

namespace elastocal {

/// Options for files in the formats of others: what such a file does not say by itself.
struct ReaderOptions {
  std::string unit = {};  ///< of lengths: mm, cm, m, in; empty: the file has to say
  /// Unit of the time of a joint log that does not state it: s, ms, us, ns; empty: s, if plausible
  /// (ToSeconds).
  std::string time_unit = {};
  std::string joints_topic = {};            ///< topic of joint states, for a bag with several
  std::string tf_frame = {};                ///< cameras' frame in a bag's tf
  std::vector<std::string> tf_bodies = {};  ///< frames of bodies; empty: all that move in tf_frame
  /// A bag that was not closed or was cut off is read up to where it ends.
  bool salvage = false;
};

/// Description of a table of static postures, by the names of its columns.
struct NamedPostures {
  struct Sight {
    std::string marker;
    int seen = 0;  ///< number of postures that show it
  };
  int count = 0;
  std::vector<Sight> markers;
  std::vector<std::string> joints;  ///< every column that is neither a marker's nor the time
  struct Column {
    std::string name;
    int filled = 0;   ///< number of rows with a cell that is no gap
    int numbers = 0;  ///< number of these cells that are numbers
    double least = 0.0, largest = 0.0;
  };
  /// For a table without columns of markers, all of its columns.
  std::vector<Column> columns = {};
};

/// Contents of a recording in any format, as far as a calibration can use them.
struct RecordingFile {
  std::string format;  ///< "C3D", "ROS 2 bag (MCAP)", ...
  /// Markers under the names of the file, m. A rigid body NAME is four of them: NAME_1 at its
  /// origin, NAME_2 to NAME_4 at 100 mm on its x, y and z axes.
  std::optional<MarkerTrajectories> markers;
  std::optional<JointLog> joints;  ///< under the names of the file, rad or m; all columns of it
  /// The axis that points up, as the file states it: "z", "-y"; empty if it does not.
  std::string up;
  /// Time of the first frame on the clock of `joints`, s, if the file has both on one clock.
  std::optional<double> markers_start_s;
  std::optional<NamedPostures> postures;      ///< for a posture table, which has no frames
  std::string why_no_markers, why_no_joints;  ///< reason for messages, if there are none
  std::vector<std::string> notes;             ///< what was skipped or assumed, one sentence each
  std::vector<std::string> salvaged;          ///< notes on files that end too early
};

/// Recognises the format by the bytes, never by the name: C3D, Vicon Nexus CSV, OptiTrack Motive
/// CSV, TRC, QTM TSV of kind 6D, NumPy .npz, MCAP, ROS 2 db3, ROS 1
/// bag. Returns the name of the format, as RecordingFile::format has it, or nothing for any other
/// file. Throws InputError for files that are surely something else: packed files, UTF-16, web
/// pages.
std::optional<std::string> RecogniseRecording(const ByteSource& source);

/// Reads a file of one of these formats, or the folder of a ROS 2 bag. Memory grows with the data
/// that are kept and not with the size of the file. Throws InputError naming file and byte, or line
/// and column: a format that is not recognised, damage, a unit that the file does not state or that
/// contradicts the options.
RecordingFile ReadRecordingFile(const std::filesystem::path& file, const ReaderOptions& options);
RecordingFile ReadRecordingFile(const ByteSource& source, const ReaderOptions& options);

}  // namespace elastocal
