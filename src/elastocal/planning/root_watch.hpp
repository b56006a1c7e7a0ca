// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/planning/place_error.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

/// How well a controller knows by its encoders where the root link is on the feet
/// (Compensator::Forward, loads by statics), against the simulator.
class RootWatch {
 public:
  /// `content`: what it knows of the calibration. Keeps a reference to the project.
  RootWatch(const Project& project, const StoredCalibration& calibration, RuntimeContent content);

  /// `support`: links of the feet that stand, one or more.
  void Look(const std::vector<int>& support, const VirtualRobot& body);

  PlaceError on_one_foot() const { return one_.Result(); }
  PlaceError on_several_feet() const { return several_.Result(); }

 private:
  const Project& project_;
  Compensator robot_;
  std::vector<int> sole_of_foot_;
  PlaceErrorSum one_, several_;
};

}  // namespace elastocal
