// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {

/// A stored calibration, and a recording to which waist and markers were fitted with its joints.
struct TransferredCalibration {
  const Project& project;
  const RecordedModel& robot;
  const Measurements& as_recorded;  ///< before markers were split at knocks
  const Recording& recording;
  const TransferValidation& transfer;
  const std::map<std::string, double>& joint_errors;  ///< by parameter name, SI
  double expected = 0.0;  ///< what the calibration errs by on other recordings, m; 0: not known
  /// Whether the calibration explains a recording as well as it should.
  std::function<bool(const Measurements&)> holds;
};

/// Faults of a recording that contradict a calibration, in words: what FindFaults and
/// FindContradictions find in trials for calibration, the joints' errors being given. Nothing is
/// looked for unless a cluster errs in a trial by more than three times what is expected; a fault
/// is one if the largest such ratio falls to less than half without it. First the scale of the
/// cameras or a gain in all trials with which the calibration holds, then faults of joints, then
/// clusters or markers that are elsewhere in some trials than in others. A joint that is off by as
/// much in all trials that show it may as well have moved since the calibration, and both are said.
std::vector<std::string> FindTransferFaults(const TransferredCalibration& calibration);

}  // namespace elastocal
