// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// Motions are sampled far more densely than postures are held, of which each counts: all of these,
/// and at most so many moments of motions, evenly. Of a table, as EvenlyThinned.
Recording WithThinnedMotions(const Recording& recording, int most);

}  // namespace elastocal
