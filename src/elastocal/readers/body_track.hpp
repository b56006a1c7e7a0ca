// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "elastocal/readers/marker_rows.hpp"

namespace elastocal {

/// Poses of a body with their time stamps, in any order.
struct BodyTrack {
  std::string name;
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> poses;  ///< x y z [m], quaternion x y z w; seven for each stamp
};

/// Poses of bodies at a constant rate.
struct RegularPoses {
  BodyPoses poses;
  double rate_hz = 0.0;
  std::int64_t start_ns = 0;  ///< stamp of the first frame
};

/// Brings tracks to one constant rate by linear interpolation between neighbours. The rate is that
/// of the median interval of the track with the most stamps. If neighbours are more than one and a
/// half intervals apart, the body was not seen between them, and a gap is left. Throws InputError
/// beginning with `source`: fewer than two stamps in every track, stamps without any regularity.
RegularPoses ResampleTracks(const std::string& source, std::vector<BodyTrack> tracks);

}  // namespace elastocal
