// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/mistakes/general_fault.hpp"

namespace elastocal {

/// Follows a fault that other trials do not tell from the opposite in all of them.
inline constexpr const char* kOrInAllOthers =
    "; it may as well be off by the opposite in all other trials that show it";

/// An offset of a joint in one trial, and what held-out trials tell of it.
struct PlacedOffset {
  RecordingFault fault;
  bool told = false;  ///< it is there
  bool refuted =
      false;  ///< they have the zero of that trial, and no single other one is off instead
};

/// A joint that two trials show may be off in the one, or by the opposite in the other: both are
/// explained as well, by robots whose zeros differ by the offset. Held-out trials have the zero of
/// one of them. The offset is moved to another trial of the estimate where that explains the trials
/// as well, and predicts the held-out ones better. The first twelve trials that move the joint are
/// tried. Other faults stay as they are.
PlacedOffset PlaceOffset(const RecordingFault& fault, const GeneralFault& general);

}  // namespace elastocal
