// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/readers/recording_file.hpp"

namespace elastocal {

/// Visibility of one marker over time.
struct MarkerSight {
  std::string name;
  double seen_share = 0.0;  ///< share of all frames
  int gaps = 0;             ///< number of gaps between frames that show it
  double longest_gap_s = 0.0;
  std::vector<double> share_by_part;  ///< share of the frames of each part of the time
};

/// Content of a recording file, for the user.
struct RecordingInfo {
  RecordingFile file;
  std::vector<MarkerSight> sights;  ///< visibility of its markers
  double log_rate_hz = 0.0;         ///< rate of the joint log by its median interval
  double longest_hole_s = 0.0;      ///< longest interval between samples of the joint log
  int torques = 0;                  ///< number of joints with torques
};

/// Describes a file of any format (ReadAnyRecording), whose time is divided into `parts`. Throws
/// InputError also for an option that has no effect on this format.
RecordingInfo DescribeRecording(const std::string& file, const ReaderOptions& options, int parts);

/// As JSON (docs/formats.md).
std::string MakeInfoJson(const RecordingInfo& info);

/// The part of a file that is written in the program's own format.
enum class RecordingPart { kOnlyOne, kMarkers, kJoints };

struct ConvertedRecording {
  std::string text;
  /// Warnings of torques of some samples only, which a log cannot hold.
  std::vector<std::string> warnings;
};

/// Converts a file to the program's own format: markers to Qualisys TSV in mm with six decimals,
/// rotated so that z points up, or joints to CSV. `up` is the axis that points up, where the file
/// does not say. Throws InputError as ReadAnyRecording, for a file without this part, a posture
/// table, both parts with kOnlyOne, an axis that is missing or contradicts the file, and an option
/// that has no effect on this file.
ConvertedRecording ConvertRecording(const std::string& path, const ReaderOptions& options,
                                    RecordingPart part, const std::string& up);

/// Whether a text was written by ConvertRecording: a TSV by its line DESCRIPTION; a joint log if it
/// has the columns of `converted` and all its numbers have the shortest exact digits.
bool IsConverted(const std::string& text, const ConvertedRecording& converted);

}  // namespace elastocal
