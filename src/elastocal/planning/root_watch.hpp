// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/planning/place_error.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "elastocal/simulation/virtual_robot.hpp"

namespace elastocal {

/// Compares a controller's estimate of the root link on the feet, by encoders
/// (Compensator::Forward, loads by statics), with the simulator.
class RootWatch {
 public:
  /// `content` is the part of the calibration that the controller knows. Keeps a reference to the
  /// project.
  RootWatch(const Project& project, const StoredCalibration& calibration, RuntimeContent content);

  /// Compares one sample. `support` holds the links of the standing feet, at least one.
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
