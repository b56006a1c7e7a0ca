// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/trial_summary.hpp"

namespace elastocal {

/// Distances between markers of clusters that most trials agree on (at least two of three): each
/// trial by itself takes what most of its frames show, and cannot tell a marker that was displaced
/// in the middle of it from one that was put right, nor labels that are exchanged in all of it.
/// Where they do not agree, the one that is clearly nearest to the distance by the project, if that
/// is in `nominal`.
PairDistances UsualDistances(const std::vector<TrialSummary>& trials, const PairDistances& nominal);

/// Distances between the markers of the robot's clusters by the project.
PairDistances NominalDistances(const MarkedRobot& robot);

/// Whether a trial took other distances than the usual ones. It is worth sampling again with
/// LabelOptions::usual then.
bool DiffersFromUsual(const TrialSummary& trial, const PairDistances& usual);

}  // namespace elastocal
