// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// All rests of a recording of trials and at most `most` moments of its motions, evenly spaced, as
/// ascending indices of postures. Motions are sampled far more densely than rests, so that fewer
/// moments tell as much.
std::vector<int> ThinnedMotions(const Recording& recording, int most);

/// The same, but at least `least` moments (or all) of each group of postures, so that there may be
/// more than `most`. `group` has one number a posture, from 0 on.
std::vector<int> ThinnedMotions(const Recording& recording, int most, const std::vector<int>& group,
                                int least);

/// The recording with these postures only. A posture table is thinned by EvenlyThinned.
Recording WithThinnedMotions(const Recording& recording, int most);

/// Indices of postures that suffice for a first, quick test of a correction of a recording: all
/// rests, at most `most` moments that the correction changes, and at most `most` of the other
/// moments, evenly spaced. Empty if these are a quarter of the postures or more, for a posture
/// table, and if the correction changes the number of postures.
std::vector<int> FewPostures(const Recording& recorded, const Recording& corrected, int most);

}  // namespace elastocal
