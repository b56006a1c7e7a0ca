// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/mistakes/general_fault.hpp"

namespace elastocal {

/// An offset of a joint in one trial, and whether held-out trials tell that it is there.
struct PlacedOffset {
  RecordingFault fault;
  bool told = false;
};

/// A joint that two trials show may be off in the one, or by the opposite in the other: both are
/// explained as well, by robots whose zeros differ by the offset. Held-out trials have the zero of
/// one of them. The offset is moved to another trial of the estimate where that explains the trials
/// as well, and predicts the held-out ones better. Other faults stay as they are.
PlacedOffset PlaceOffset(const RecordingFault& fault, const GeneralFault& general);

}  // namespace elastocal
