// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/readers/byte_source.hpp"

namespace elastocal {

/// What a file of somebody else's format does not say by itself.
struct ReaderOptions {
  std::string unit = {};  ///< of lengths: mm, cm, m, in; empty: the file has to say
  /// Of the time of a joint log that does not state it: s, ms, us, ns; empty: s, if that can be.
  std::string time_unit = {};
  std::string joints_topic = {};            ///< of a bag with several topics of joint states
  std::string tf_frame = {};                ///< of a bag's tf: the cameras' frame
  std::vector<std::string> tf_bodies = {};  ///< frames that are bodies; empty: all that move in it
  /// A bag that was not closed or was cut off is read up to where it ends.
  bool salvage = false;
};

/// What the names of columns say of a table of static postures.
struct NamedPostures {
  struct Sight {
    std::string marker;
    int seen = 0;  ///< postures that show it
  };
  int count = 0;
  std::vector<Sight> markers;
  std::vector<std::string> joints;  ///< every column that is neither a marker's nor the time
  struct Column {
    std::string name;
    int filled = 0;   ///< rows that have something there
    int numbers = 0;  ///< of these, numbers
    double least = 0.0, largest = 0.0;
  };
  /// Of a table without columns of markers: all of its columns, as they are.
  std::vector<Column> columns = {};
};

/// What a recording in any format holds, as far as a calibration can use it.
struct RecordingFile {
  std::string format;  ///< "C3D", "ROS 2 bag (MCAP)", ...
  /// Markers under the names of the file, m. A rigid body NAME is four of them: NAME_1 at its
  /// origin, NAME_2 to NAME_4 at 100 mm on its x, y and z axes.
  std::optional<MarkerTrajectories> markers;
  std::optional<JointLog> joints;  ///< under the names of the file, rad or m; all columns of it
  /// The axis that points up, as the file states it: "z", "-y"; empty where it does not.
  std::string up;
  /// Time of the first frame on the clock of `joints`, s, where the file has both on one clock.
  std::optional<double> markers_start_s;
  std::optional<NamedPostures> postures;      ///< of a posture table, which has no frames
  std::string why_no_markers, why_no_joints;  ///< for messages, where there are none
  std::vector<std::string> notes;             ///< what was skipped or taken how, a sentence each
  std::vector<std::string> salvaged;          ///< notes on files that end too early
};

/// Recognises the format by the bytes, never by the name: C3D, Vicon Nexus CSV, OptiTrack Motive
/// CSV, TRC, QTM TSV of kind 6D, NumPy .npz, MCAP, ROS 2 db3, ROS 1
/// bag. Nothing for anything else. The name
/// is that of RecordingFile::format. Throws InputError for what is surely something else: packed
/// files, UTF-16, web pages.
std::optional<std::string> RecogniseRecording(const ByteSource& source);

/// Reads such a file, or the folder of a ROS 2 bag. Memory grows with what is kept of it and not
/// with its size. Throws InputError naming file and byte, or line and column: a format that is not
/// recognised, damage, a unit that the file does not state or that contradicts the options.
RecordingFile ReadRecordingFile(const std::filesystem::path& file, const ReaderOptions& options);
RecordingFile ReadRecordingFile(const ByteSource& source, const ReaderOptions& options);

}  // namespace elastocal
