// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// All postures that are held, and at most so many moments of motions, evenly: motions are sampled
/// far more densely, so that fewer moments tell as much. Of a recording of trials; ascending.
std::vector<int> ThinnedMotions(const Recording& recording, int most);

/// These postures. A table is thinned by EvenlyThinned.
Recording WithThinnedMotions(const Recording& recording, int most);

/// Postures by which a correction of a recording can be tried before all of them are: those of rest
/// and, of the moments of motions, evenly so many of those that the correction changes and so many
/// of the others. Empty where that is not much quicker: a quarter of the postures or more, a table,
/// or a correction that leaves postures out.
std::vector<int> FewPostures(const Recording& recorded, const Recording& corrected, int most);

}  // namespace elastocal
