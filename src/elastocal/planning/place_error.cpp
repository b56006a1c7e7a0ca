// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/place_error.hpp"

#include <algorithm>
#include <cmath>

namespace elastocal {

void PlaceErrorSum::Add(const Transform& wanted, const Transform& got) {
  Add((got.translation() - wanted.translation()).norm(),
      Eigen::AngleAxisd(wanted.linear().transpose() * got.linear()).angle());
}

void PlaceErrorSum::Add(double distance, double angle) {
  squares_ += distance * distance;
  turns_ += angle * angle;
  result_.max_m = std::max(result_.max_m, distance);
  result_.max_rad = std::max(result_.max_rad, angle);
  ++result_.samples;
}

PlaceError PlaceErrorSum::Result() const {
  PlaceError result = result_;
  if (result.samples > 0) {
    result.rms_m = std::sqrt(squares_ / result.samples);
    result.rms_rad = std::sqrt(turns_ / result.samples);
  }
  return result;
}

}  // namespace elastocal
