// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Function that fits a recording.
using FitOf =
    std::function<CalibrationResult(const ErrorModel&, const BaseParameters&, const Recording&)>;

/// Inputs of ExplainFault: the fault that explains most of the residuals of a fit, and what was
/// fitted.
struct GeneralFault {
  RecordingFault fault;
  ErrorModel model;
  BaseParameters base;
  Recording recording;
  ModelKind kind = ModelKind::kGeometric;
  CalibrationOptions options;
  /// Trials for validation, which tell in which trials gains are; may be empty.
  Recording held_out = {};
  FitOf fit = {};  ///< replaces Calibrate, for robots whose joints are known; empty: Calibrate
};

/// Text such as "arm_4_joint: its positions are 1.05 +- 0.01 times the true ones (--accept NAME
/// corrects it)". Beside the gain of a slide, the text has the scale of the cameras that explains
/// as much, with its name.
std::string FaultAndRemedy(const RecordingFault& fault, const RobotTree& tree,
                           const Recording& recording);

/// The same of several faults, without names where one of them has none.
std::string FaultsAndRemedies(const std::vector<RecordingFault>& faults, const RobotTree& tree,
                              const Recording& recording);

/// Result of ExplainFault.
struct FaultsInWords {
  std::string text;
  bool complete = false;  ///< few faults explain the recording
  /// Rms distance of the markers from a robot that is fitted without the faults, m.
  double left = 0.0;
  std::vector<RecordingFault> faults = {};
  /// Held-out trials tell in which trial the joint is off, or that it need not be that one, which
  /// the text then says (PlaceOffset).
  bool placed = false;
};

/// Finds out whether the fault is the only one, and describes the result. The fault that explains
/// most need not be the true one: it is corrected, the robot is fitted again, and the residuals are
/// searched as before, until nothing is found. Several faults are named together, each with its
/// size beside the others. If a cluster that is displaced on its link from the same posture on
/// explains as much as several joints do, the cluster is named. Joints that are off from the same
/// posture on, or in the same trial, are named as another robot or as new zeros of all of them. If
/// four faults do not explain the recording, the sentence says so and recommends no correction.
FaultsInWords ExplainFault(const GeneralFault& general, const Project& project);

}  // namespace elastocal
