// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/formats.hpp"

/// What every reader of recordings promises: a value that makes sense, or an InputError.
inline int FuzzRecording(const std::uint8_t* data, std::size_t size,
                         elastocal::RecordingFile (*read)(const elastocal::ByteSource&,
                                                          const elastocal::ReaderOptions&)) {
  using namespace elastocal;
  try {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    ReaderOptions options;
    if (size % 2 == 1) options.unit = "mm";
    if (size % 3 == 1) options.tf_frame = "room";
    if (size % 3 == 2) options.tf_frame = "cameras";
    if (size % 5 == 1) options.tf_bodies = {"tool"};
    options.salvage = size % 7 == 1;
    const RecordingFile file = read(ByteSource::OfMemory(bytes, "fuzz"), options);
    if (file.markers) {
      const MarkerTrajectories& markers = *file.markers;
      if (!(markers.rate_hz > 0.0)) std::abort();
      if (markers.positions.cols() != 3 * markers.marker_count()) std::abort();
      for (Eigen::Index i = 0; i < markers.positions.rows(); ++i) {
        for (Eigen::Index c = 0; c < markers.positions.cols(); c += 3) {
          const auto gaps = markers.positions.block<1, 3>(i, c).array().isNaN().count();
          if (gaps == 1 || gaps == 2) std::abort();
        }
      }
    }
    if (file.joints) {
      const JointLog& log = *file.joints;
      if (log.positions.rows() != log.sample_count() || !log.positions.allFinite()) std::abort();
      for (Eigen::Index i = 1; i < log.time_s.size(); ++i) {
        if (!(log.time_s[i] > log.time_s[i - 1])) std::abort();
      }
    }
  } catch (const InputError&) {
    return 0;
  }
  return 0;
}
