// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/recording_file.hpp"

#include <array>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

struct Format {
  const char* name;
  bool (*is)(std::string_view head);
  RecordingFile (*read)(const ByteSource& source, const ReaderOptions& options);
};

constexpr std::array kFormats = {
    Format{"C3D", IsC3d, ReadC3d},
    Format{"MCAP", IsMcap, ReadMcap},
    Format{"ROS 1 bag", IsRosbag1, ReadRosbag1},
    Format{"ROS 2 bag (db3)", IsRosbag2Db3, ReadRosbag2Db3},
    Format{"NumPy .npz", IsNpz, ReadNpz},
    Format{"Vicon Nexus CSV", IsViconCsv, ReadViconCsv},
    Format{"OptiTrack Motive CSV", IsMotiveCsv, ReadMotiveCsv},
    Format{"TRC", IsTrc, ReadTrc},
    Format{"Qualisys TSV (6D, analogue or force)", IsQtmOther, ReadQtmOther},
};

/// A kind of file that people take for a recording, by its first bytes, and advice for it.
struct OtherKind {
  std::string_view begin;
  const char* words;
};

constexpr std::array kOtherKinds = {
    OtherKind{"\x1F\x8B", "it is compressed by gzip; unpack it first (gunzip)"},
    OtherKind{"\x28\xB5\x2F\xFD", "it is compressed by zstd; unpack it first (zstd -d)"},
    OtherKind{{"\xFD"
               "7zXZ\0",
               6},
              "it is compressed by xz; unpack it first (unxz)"},
    OtherKind{"\x93NUMPY",
              "it is a single array of NumPy; save names, times and positions by numpy.savez "
              "(docs/formats.md, Recordings of others)"},
    OtherKind{"\x89HDF\r\n", "it is an HDF5 or MATLAB file; export it as CSV or .npz"},
    OtherKind{"MATLAB 5.0 MAT-file", "it is a MATLAB file; export it as CSV or .npz"},
    OtherKind{"\xFF\xFE", "it is text in UTF-16; save it as UTF-8"},
    OtherKind{"\xFE\xFF", "it is text in UTF-16; save it as UTF-8"},
    OtherKind{"version https://git-lfs",
              "it is a pointer of Git LFS; `git lfs pull` fetches the file"},
    OtherKind{"<!DOCTYPE html", "it is a web page, not the file that was to be downloaded"},
    OtherKind{"<!doctype html", "it is a web page, not the file that was to be downloaded"},
    OtherKind{"<html", "it is a web page, not the file that was to be downloaded"},
};

const Format* FindFormat(const ByteSource& source) {
  std::array<char, 4096> head{};
  std::string_view bytes(head.data(), source.Read(0, head));
  for (const OtherKind& other : kOtherKinds) {
    if (bytes.starts_with(other.begin)) throw InputError(source.name() + ": " + other.words);
  }
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  for (const Format& format : kFormats) {
    if (format.is(bytes)) return &format;
  }
  return nullptr;
}

/// Throws InputError for positions that are beyond any laboratory.
void CheckRoom(const MarkerTrajectories& markers) {
  constexpr double kLargest = 1000.0;  // m
  for (Eigen::Index column = 0; column < markers.positions.cols(); ++column) {
    for (Eigen::Index frame = 0; frame < markers.positions.rows(); ++frame) {
      const double found = markers.positions(frame, column);
      if (!(std::abs(found) > kLargest)) continue;
      throw InputError(markers.source + ": frame " + std::to_string(frame + 1) + ", marker " +
                       Quote(markers.names[static_cast<std::size_t>(column / 3)]) + ": found " +
                       FormatNumber(found) +
                       " m; at most 1000 m was expected (is the unit right?)");
    }
  }
}

}  // namespace

std::optional<std::string> RecogniseRecording(const ByteSource& source) {
  if (const Format* format = FindFormat(source)) return format->name;
  return std::nullopt;
}

RecordingFile ReadRecordingFile(const std::filesystem::path& file, const ReaderOptions& options) {
  return ReadRecordingFile(ByteSource::Open(file), options);
}

RecordingFile ReadRecordingFile(const ByteSource& source, const ReaderOptions& options) {
  const Format* const format = FindFormat(source);
  if (!format) {
    std::string known;
    for (const Format& one : kFormats) known += (known.empty() ? "" : ", ") + std::string(one.name);
    throw InputError(source.name() + ": is of no known format; known by their contents are " +
                     known);
  }
  RecordingFile file = format->read(source, options);
  if (file.markers) CheckRoom(*file.markers);
  file.format = format->name;
  return file;
}

}  // namespace elastocal
