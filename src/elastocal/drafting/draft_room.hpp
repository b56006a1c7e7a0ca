// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/drafting/draft.hpp"

namespace elastocal {

// A draft leaves room for what a calibration will correct (correction_room.hpp): motions that are
// planned for the nominal robot have to be possible for the real one.

/// Keeps elbows and knees bent (BentRanges), in whole degrees. Arms move there, unless the SRDF has
/// named postures; other limbs keep their posture of rest, which is part of their range.
void BendLimbs(ProjectDraft& draft, const Semantics& semantics);

/// Widens the margin between parts to what may remain between two limbs when their ends are back in
/// place, and leaves the corrections of joints free at their limits, in whole degrees (RoomSds of
/// as many).
void LeaveRoomForCorrections(ProjectDraft& draft);

/// Makes spheres smaller that are apart by less than the margin in a posture of rest, but by
/// `usual_margin` or more, so that their pairs are checked: by half of what is missing each. With
/// the wider margin, they still keep more distance from others than before.
void ShrinkToMargin(ProjectDraft& draft, const Semantics& semantics, double usual_margin);

}  // namespace elastocal
