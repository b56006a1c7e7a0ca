// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {

/// Fills in the verdict. There is an objection where the estimate has not converged, is no better
/// than the uncalibrated robot, makes any kind of observation clearly worse, needs errors that no
/// robot has (ten times the expected ones), or leaves errors that no calibrated robot has
/// (LargeErrors). The first objection names the mistakes in the tables that explain them
/// (FindObservedMistakes).
void JudgeContacts(ContactRun& run);

/// What has to be compensated for the errors of the run to hold, where they are not those of its
/// geometry alone (CompensationInWords).
std::string CompensationOf(const ContactRun& run);

}  // namespace elastocal
