// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// A posture whose observations belong to another session than its row says.
struct OtherSession {
  int posture = 0;
  std::string said, seen;
};

/// Finds postures with a wrong session, in their order; empty where all are plausible.
///
/// Each posture that its session does not explain is assigned to the session that leaves the
/// smallest residuals, and the robot is estimated again, until nothing changes. The result counts
/// if at most a third of the postures then have another session, and at most half of the noise of
/// heights, or of another measured quantity, is left.
///
/// If so many sessions are exchanged that their names say nothing, the residuals of an instrument
/// in two sessions form two heaps. In that case half of the postures may have another session (it
/// may as well be the other half), and at most three tenths of the noise may be left.
std::vector<OtherSession> FindExchangedSessions(const ObservedRobot& model,
                                                const Observations& observations);

/// The observations with these postures in the sessions to which they seem to belong.
Observations InOtherSessions(const std::vector<OtherSession>& postures,
                             const Observations& observations);

}  // namespace elastocal
