// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {

/// Leaves touches in the air (FindTouchesInTheAir) out of the observations; whether there were
/// some. A few are a warning; where they are more than a quarter of a plate's touches, as of
/// outliers, `mostly_air` is the objection: too few are left to tell which are right.
bool LeaveOutTouchesInTheAir(ContactRun& run);

}  // namespace elastocal
