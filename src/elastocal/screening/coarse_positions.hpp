// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/trial_summary.hpp"

namespace elastocal {

/// A joint whose recorded positions are rounded to steps.
struct CoarsePositions {
  int coordinate = -1;
  double step = 0.0;  ///< rad or m
  double off = 0.0;   ///< rms deviation from the recorded positions that the markers show, rad or m
};

/// Finds joints whose positions are rounded to steps of at least 0.1 degrees or 0.2 mm, and whose
/// markers show the deviation within the step: the log is rounded, or the encoder is coarse. (A
/// robot may also be sent to round positions, but then the markers show no deviation.) To decide
/// it, each position is moved within its step to where the markers of its posture are nearest to
/// the fit `result`, for all these joints in turn. The joints are returned if this removes at least
/// a fifth of the squared distances, and at least three times as much as so many free numbers
/// remove from noise. A joint is returned only if its positions moved by at least half of a
/// rounding's standard deviation (step / sqrt(12)), rms. With `trials`, steps are those of their
/// logs, because a posture is a mean.
std::vector<CoarsePositions> FindCoarsePositions(const CalibrationResult& result,
                                                 const Recording& recording,
                                                 const CalibrationOptions& options,
                                                 const std::vector<TrialSummary>& trials);

/// Whether the step is larger than that of any good encoder or log: half a degree or 1 mm.
bool IsTooCoarse(const CoarsePositions& coarse, const RobotTree& tree);

/// Text such as "arm_3_joint: its positions come in steps of 1 deg, and the markers show it beside
/// them (0.29 deg rms): ...".
std::string Describe(const CoarsePositions& coarse, const RobotTree& tree);

/// A joint whose positions have a different error in each posture.
struct ScatteredPositions {
  int coordinate = -1;
  double off = 0.0;   ///< standard deviation of the errors, by their median size; rad or m
  double left = 1.0;  ///< share of the squared distances that is left without these errors
};

/// Finds the joint whose positions scatter, for example due to a worn or loose encoder; no column,
/// row or trial has such errors in common. In each posture the joint is moved to where the markers
/// are nearest to the fit `result`. The joint that removes most of the squared distances is
/// returned, if that is at least half of them and more than so many free numbers remove from noise,
/// and if `off` is at least 0.25 degrees or 1 mm. An error that a joint has throughout a trial (its
/// median there) is no scatter.
std::optional<ScatteredPositions> FindScatteredPositions(const CalibrationResult& result,
                                                         const Recording& recording,
                                                         const CalibrationOptions& options);

/// Whether the scatter is larger than that of any joint that is worth calibrating: more than 0.5
/// degrees or 2 mm, and more than three fifths of the squared distances. (The wrist of a real TIAGo
/// has 0.27 degrees of play, which cause 55 %.)
bool IsTooLoose(const ScatteredPositions& scattered, const RobotTree& tree);

/// Text such as "arm_3_joint: its positions scatter by 0.9 deg (sd) about where the markers show
/// them, ...".
std::string Describe(const ScatteredPositions& scattered, const RobotTree& tree);

}  // namespace elastocal
