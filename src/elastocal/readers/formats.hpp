// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "elastocal/readers/recording_file.hpp"

namespace elastocal {

// One pair of functions for each format. Is... says whether a file that begins with these bytes (up
// to 4096) has the format. Read... reads all of the file.

bool IsC3d(std::string_view head);
RecordingFile ReadC3d(const ByteSource& source, const ReaderOptions& options);

bool IsViconCsv(std::string_view head);
RecordingFile ReadViconCsv(const ByteSource& source, const ReaderOptions& options);

bool IsMotiveCsv(std::string_view head);
RecordingFile ReadMotiveCsv(const ByteSource& source, const ReaderOptions& options);

bool IsTrc(std::string_view head);
RecordingFile ReadTrc(const ByteSource& source, const ReaderOptions& options);

/// QTM TSV of the kinds 6D (bodies), and ANALOG or force, which hold nothing for a calibration.
bool IsQtmOther(std::string_view head);
RecordingFile ReadQtmOther(const ByteSource& source, const ReaderOptions& options);

bool IsNpz(std::string_view head);
RecordingFile ReadNpz(const ByteSource& source, const ReaderOptions& options);

bool IsMcap(std::string_view head);
RecordingFile ReadMcap(const ByteSource& source, const ReaderOptions& options);

bool IsRosbag1(std::string_view head);
RecordingFile ReadRosbag1(const ByteSource& source, const ReaderOptions& options);

bool IsRosbag2Db3(std::string_view head);
RecordingFile ReadRosbag2Db3(const ByteSource& source, const ReaderOptions& options);

}  // namespace elastocal
