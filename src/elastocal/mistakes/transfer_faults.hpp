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

/// A stored calibration and a recording to which waist and markers were fitted with its joints.
struct TransferredCalibration {
  const Project& project;
  const RecordedModel& robot;
  const Measurements& as_recorded;  ///< before markers were split at knocks
  const Recording& recording;
  const TransferValidation& transfer;
  const std::map<std::string, double>& joint_errors;  ///< by parameter name, SI
  double expected = 0.0;  ///< expected error of the calibration on other recordings, m; 0: unknown
  /// Whether the calibration explains a recording as well as expected.
  std::function<bool(const Measurements&)> holds;
};

/// Describes faults of a recording that contradict a calibration: what FindFaults and
/// FindContradictions find in trials for calibration, but with given errors of the joints. Nothing
/// is searched unless the error of a cluster in a trial exceeds three times the expected one. A
/// fault counts if the largest such ratio falls to less than half with it corrected. The search
/// examines first the scale of the cameras, or a gain in all trials, with which the calibration
/// holds, then faults of joints, then clusters or markers that are displaced in some trials. A
/// joint with the same offset in all trials that show it may as well have moved since the
/// calibration; both are then named.
std::vector<std::string> FindTransferFaults(const TransferredCalibration& calibration);

}  // namespace elastocal
