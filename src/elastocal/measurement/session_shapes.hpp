// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/trial_summary.hpp"

namespace elastocal {

/// The usual distances between markers of clusters, m. A trial by itself takes the distance that
/// most of its frames show. It cannot tell a marker that was displaced in its middle from one that
/// was put back, nor labels that are exchanged in all of it. Trials together can: the usual
/// distance is the one on which more than half of at least three trials agree. If there is none,
/// and the pair is in `nominal`, it is the distance nearest to the nominal one, provided that all
/// distances that differ from it are at least twice as far from nominal. Other pairs are left out.
PairDistances UsualDistances(const std::vector<TrialSummary>& trials, const PairDistances& nominal);

/// Nominal distances between the markers of the robot's clusters, m.
PairDistances NominalDistances(const MarkedRobot& robot);

/// Whether a distance of a trial differs from the usual one by more than its tolerance. Such a
/// trial should be sampled again with LabelOptions::usual.
bool DiffersFromUsual(const TrialSummary& trial, const PairDistances& usual);

}  // namespace elastocal
