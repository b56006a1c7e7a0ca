// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/readers/recording_file.hpp"

namespace elastocal {

/// When one marker was seen.
struct MarkerSight {
  std::string name;
  double seen_share = 0.0;  ///< of all frames
  int gaps = 0;             ///< between frames that show it
  double longest_gap_s = 0.0;
  std::vector<double> share_by_part;  ///< of the frames of each part of the time
};

/// What a recording holds, for people.
struct RecordingInfo {
  RecordingFile file;
  std::vector<MarkerSight> sights;  ///< of its markers
  double log_rate_hz = 0.0;         ///< by the median interval of the joint log
  double longest_hole_s = 0.0;      ///< between samples of the joint log
  int torques = 0;                  ///< joints with torques
};

/// Looks through a file of any format (ReadAnyRecording), whose time is divided into `parts`.
/// Throws InputError for an option that does nothing with a file of this format, too.
RecordingInfo DescribeRecording(const std::string& file, const ReaderOptions& options, int parts);

/// As JSON (docs/formats.md).
std::string MakeInfoJson(const RecordingInfo& info);

/// What of a file is written in the program's own format.
enum class RecordingPart { kOnlyOne, kMarkers, kJoints };

struct ConvertedRecording {
  std::string text;
  std::vector<std::string> warnings;  ///< torques of some samples only, which a log cannot hold
};

/// The file in the program's own format: markers as Qualisys TSV in mm with six decimals, turned
/// so that z points up, or joints as CSV. `up`: the axis that points up, where the file does not
/// say. Throws InputError: what ReadAnyRecording refuses; a file without this part; a posture
/// table; both parts with kOnlyOne; an axis that nobody says or that contradicts the file; an
/// option that does nothing with this file.
ConvertedRecording ConvertRecording(const std::string& path, const ReaderOptions& options,
                                    RecordingPart part, const std::string& up);

/// Whether a text is of ConvertRecording: TSV by its line DESCRIPTION; a joint log if it has the
/// columns of `converted` and all of its numbers the shortest digits that say them.
bool IsConverted(const std::string& text, const ConvertedRecording& converted);

}  // namespace elastocal
