// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// A posture that what was observed in it puts into another session than its row says.
struct OtherSession {
  int posture = 0;
  std::string said, seen;
};

/// Postures with the session of others, in their order; none where all are plausible.
///
/// Each posture that its session does not explain is taken as one of the session that leaves least,
/// and the robot is estimated anew, until nothing changes. Sessions are exchanged where no more
/// than a third of the postures have another one then, and less than half of the noise of heights,
/// or of what else is measured, is left.
///
/// Where so many are exchanged that a session says nothing, what an instrument shows in two
/// sessions lies in two heaps: half of the postures may have another session then, which may as
/// well be the other half, and three tenths of the noise may be left.
std::vector<OtherSession> FindExchangedSessions(const ObservedRobot& model,
                                                const Observations& observations);

/// The observations with these postures in the sessions that they seem to be of.
Observations InOtherSessions(const std::vector<OtherSession>& postures,
                             const Observations& observations);

}  // namespace elastocal
