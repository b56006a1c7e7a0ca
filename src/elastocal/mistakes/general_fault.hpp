// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// How a recording is fitted.
using FitOf =
    std::function<CalibrationResult(const ErrorModel&, const BaseParameters&, const Recording&)>;

/// The fault that explains most of what a fit leaves, and what was fitted.
struct GeneralFault {
  RecordingFault fault;
  ErrorModel model;
  BaseParameters base;
  Recording recording;
  ModelKind kind = ModelKind::kGeometric;
  CalibrationOptions options;
  Recording held_out = {};  ///< trials for validation, by which gains are placed; may be empty
  FitOf fit = {};           ///< instead of Calibrate, of robots whose joints are known
};

/// "arm_4_joint: its positions are 1.05 +- 0.01 times the true ones (--accept NAME corrects it)"
std::string FaultAndRemedy(const RecordingFault& fault, const RobotTree& tree,
                           const Recording& recording);

struct FaultsInWords {
  std::string text;
  bool complete = false;  ///< few faults explain the recording
  double left = 0.0;      ///< rms distance of the markers from a robot fitted without them, m
  std::vector<RecordingFault> faults = {};
  bool placed = false;  ///< held-out trials tell in which trial the joint is off (PlaceOffset)
};

/// The same, once it is known whether it is the only one. What explains most need not be what is
/// wrong: the fault is undone, the robot fitted again, and what is left searched as before, until
/// nothing is found. Several faults are said together, each by its size beside the others. Where a
/// cluster that is elsewhere on its link from there on explains as much as several joints do, it is
/// the cluster; joints that are off from the same posture or in the same trial are another
/// robot or a new zero of all; and where four faults do not explain the recording, the sentence
/// says that, and recommends no correction.
FaultsInWords ExplainFault(const GeneralFault& general, const Project& project);

}  // namespace elastocal
