// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// A part of a recording: a trial, or the postures from one of the given folders.
struct PartOfRecording {
  std::string name;
  std::vector<int> postures;
};

/// Combines the rms errors of several parts (`errors`, m) into the rms over all markers seen in
/// these parts, m.
double ErrorOverParts(const Recording& recording, const std::vector<PartOfRecording>& parts,
                      const std::vector<double>& errors);

/// Root mean square distance of the markers of a part of a recording from a robot that is fitted to
/// it alone, m. It is corrected for the freedom of that fit. Infinite where the part has too few
/// equations, or where the estimate is impossible for a robot (FitError).
double ErrorAlone(const RecordedModel& robot, const Recording& part, ModelKind kind,
                  const CalibrationOptions& options);

/// Parts of a recording that no single robot explains, in words, and the rms error that a separate
/// robot for each leaves, m.
struct PartsApart {
  std::string said;
  double error = 0.0;
};

/// Whether parts contradict each other: separate robots leave less than half of the error of one
/// common robot, and at least 0.2 mm less. Both errors are rms, m.
bool AreApart(double error_apart, double error_together);

/// Finds trials that no single robot explains; nothing where one does. Trials contradict each other
/// if a separate robot for each leaves far less error than one robot for all (AreApart). Effects
/// that a trial exercises and no model describes seldom disappear in a separate fit, but an error
/// that is constant throughout a trial does.
///
/// Trials that one robot explains are then collected into sets (CollectAlike), by at most four
/// times as many fits as there are trials. The error of a set must be less than the geometric mean
/// of the error with separate robots and that with one robot, and less than three times the former.
/// Nothing is returned if all trials form one set. Where the fits do not suffice, it is said that
/// few robots do not explain the trials. Trials with too few equations are left out. Recordings
/// with more than 50 trials are not examined. `recording` is that of `together`. `most` is the
/// error that another explanation of the recording leaves, m; where it is smaller, it replaces the
/// error with one robot.
std::optional<PartsApart> FindTrialsApart(const RecordedModel& robot, const Recording& recording,
                                          const CalibrationResult& together, double most,
                                          const CalibrationOptions& options);

}  // namespace elastocal
