// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/foot_rests.hpp"

namespace elastocal {

// Not in the paper. Eq. 6 has what gives way between the markers of a standing foot and the waist.
// What gives way below these markers (a sole of rubber, a force sensor, a soft floor) shows only
// where one foot, without being set down anew, carries now more and now less.

inline constexpr double kSoftestSole = 1e-4;  ///< m/N: a person sinks by 80 mm

/// How much the markers of a foot sink under the load on its sole.
struct SoleSpring {
  std::string leg;  ///< of the model
  int changes = 0;  ///< of load, from trial to trial, of the foot that stayed where it stood
  double compliance = 0.0;                              ///< along gravity, m/N
  double sd = std::numeric_limits<double>::infinity();  ///< m/N; infinite: no such changes
  double interval_factor = 1.96;  ///< half width of a 95 % interval in standard deviations

  /// Whether it differs from zero at 95 %, so that it may be applied.
  bool told() const { return compliance > interval_factor * sd; }
  /// Upper end of the interval, m/N.
  double most() const;
};

/// One entry a leg of the model. `rests`: of all trials, whatever they were recorded for; those of
/// the same folder and foot follow on each other. `gravity` is in the frame of their markers,
/// m/s^2.
///
/// A foot stays from one trial of a folder to the next if it supports the robot in both and its
/// markers, as one body, are within 0.3 mm and 0.3 degrees of where they were (5 mm in height). The
/// height of its link's origin is then a constant less compliance times load (least squares), and
/// the load is its share of the weight of the robot as described.
///
/// The standard deviation is the scatter about these lines together with what the feet moved along
/// the floor, where no load moves them: drifting cameras and knocked clusters make it large. 5 % of
/// the load come on top, as masses of a description and the share of two feet are known.
std::vector<SoleSpring> EstimateSoleSprings(const CalibrationResult& result,
                                            const std::vector<FootRest>& rests,
                                            const Eigen::Vector3d& gravity);

}  // namespace elastocal
