// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/math/transform.hpp"

namespace elastocal {

/// Deviation from a wanted pose over all samples: root mean square and largest value.
struct PlaceError {
  double rms_m = 0.0, max_m = 0.0;
  double rms_rad = 0.0, max_rad = 0.0;
  int samples = 0;
};

/// Sums up deviations, sample by sample.
class PlaceErrorSum {
 public:
  void Add(const Transform& wanted, const Transform& got);
  void Add(double distance, double angle);
  PlaceError Result() const;

 private:
  PlaceError result_;
  double squares_ = 0.0, turns_ = 0.0;
};

}  // namespace elastocal
