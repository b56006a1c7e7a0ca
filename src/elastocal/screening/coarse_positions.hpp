// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/trial_summary.hpp"

namespace elastocal {

/// A joint whose positions were recorded in steps.
struct CoarsePositions {
  int coordinate = -1;
  double step = 0.0;  ///< rad or m
  double off = 0.0;   ///< rms of what the markers show besides, rad or m
};

/// Joints, of what a fit leaves, whose positions come in steps of 0.1 degrees or 0.2 mm and more,
/// and are off by a part of a step as the markers show it: those of a rounded log, or of an encoder
/// that knows no better. A robot may also have been sent to round numbers: then the markers show
/// nothing beside. So each position is moved within its step to where it brings the markers of its
/// posture nearest, of all these joints in turn. They are returned where that takes a fifth of the
/// squared distances, and three times what as many numbers take of noise; each that was moved by
/// half of what rounding does (step / sqrt(12)) and more. Steps of `trials` are those of their
/// logs: a posture is a mean.
std::vector<CoarsePositions> FindCoarsePositions(const CalibrationResult& result,
                                                 const Recording& recording,
                                                 const CalibrationOptions& options,
                                                 const std::vector<TrialSummary>& trials);

/// Whether the steps are such as no good encoder and no good log has: half a degree or 1 mm.
bool IsTooCoarse(const CoarsePositions& coarse, const RobotTree& tree);

/// "arm_3_joint: its positions come in steps of 1 deg, and the markers show it up to half a step
/// beside them (0.29 deg rms): ...".
std::string Describe(const CoarsePositions& coarse, const RobotTree& tree);

/// A joint whose positions are off by another amount in each posture.
struct ScatteredPositions {
  int coordinate = -1;
  double off = 0.0;   ///< standard deviation, by the median size; rad or m
  double left = 1.0;  ///< share of the squared distances that is left without
};

/// The joint, of what a fit leaves, that takes most of the squared distances, half and more, when
/// it is moved in each posture to where it brings the markers nearest: a worn or loose encoder,
/// whose errors no column, row or trial has in common. Nothing where the usual posture is off by
/// less than 0.25 degrees or 1 mm, or where so many numbers would take as much of noise. What a
/// joint is off by throughout a trial, by the median, is no scatter.
std::optional<ScatteredPositions> FindScatteredPositions(const CalibrationResult& result,
                                                         const Recording& recording,
                                                         const CalibrationOptions& options);

/// Whether no joint that is worth calibrating does so: 0.5 degrees or 2 mm, which make three fifths
/// of the squared distances. The wrist of a real TIAGo has 0.27 degrees of play, which make 55 %.
bool IsTooLoose(const ScatteredPositions& scattered, const RobotTree& tree);

/// "arm_3_joint: its positions scatter by 0.9 deg (sd) about where the markers show them, ...".
std::string Describe(const ScatteredPositions& scattered, const RobotTree& tree);

}  // namespace elastocal
