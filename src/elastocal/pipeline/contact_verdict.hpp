// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {

/// Fills in the verdict: objections where the estimate has not converged, is no better than the
/// uncalibrated robot, makes any kind of observation clearly worse, needs errors that no robot has
/// (ten times what is expected of one), or leaves errors that no calibrated robot has
/// (LargeErrors). The first objection names the mistakes in the tables that explain it
/// (FindObservedMistakes).
void JudgeContacts(ContactRun& run);

/// What the errors of the run hold with, where they are not those of its geometry alone
/// (CompensationInWords).
std::string CompensationOf(const ContactRun& run);

}  // namespace elastocal
