// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// What may be wrong with tables of observations beyond single rows.
enum class ObservationFaultKind {
  kJointGain,    ///< a joint's positions are a multiple of the true ones
  kJointOffset,  ///< a joint's positions are off by a constant from a posture on
  kJointFrozen,  ///< a joint's positions stay the same in some postures, where it moved
  kMoved,        ///< what stands beside the robot (a tracker, a table) was moved
};

/// A fault that explains much of what the fit leaves.
struct ObservationFault {
  ObservationFaultKind kind = ObservationFaultKind::kJointGain;
  int coordinate = -1;  ///< of the robot tree
  int quantity = -1;    ///< of the setup, that was moved
  int posture = 0;      ///< the first one that it is in
  int count = 0;        ///< of frozen positions: in how many postures
  /// Gain less 1; offset, rad or m; of a move, the displacement [m] or turn [rad] that explains
  /// most of it; 0 of frozen positions.
  double size = 0.0;
  double sd = 0.0;     ///< of `size`
  bool turns = false;  ///< of a move: `size` is an angle
  double share = 0.0;  ///< of the sum of squared residuals that it explains
};

/// Looks for the faults that explain most of what a fit has left: each is one more unknown beside
/// all others (score test), so that it is not confused with what errors of the robot explain as
/// well. Observations that were left out take part with a limited weight. Returned are those of a
/// size that matters (gain 0.5 %; offset 0.25 degrees, 1 mm; move 0.5 mm, 0.05 degrees), certain
/// (four standard deviations, in noise that has the fault in it) and a fifth of what is left, the
/// one that explains most first, one for each joint or quantity; among them joints that are logged
/// in exactly the same place in five and more postures that follow each other, which are worse than
/// the others.
std::vector<ObservationFault> FindObservationFaults(const ObservedRobot& model,
                                                    const Observations& observations,
                                                    const ObservationFit& fit);

/// The longest run of postures in which a joint is logged in exactly the same place; nothing where
/// it has fewer than five, or more than half of all.
std::optional<ObservationFault> FindFrozen(const Observations& observations, int coordinate);

/// The fault with its size refined, by what is left of it beside a fit without it: the score test
/// tells it to first order. The standard deviation stays: that of a fit without the fault does not
/// know what the model lacks. Of frozen positions and what was moved, nothing changes.
ObservationFault Refined(ObservationFault fault, const ObservedRobot& model,
                         const Observations& observations);

/// The observations as they would be without the fault: what was moved varies from there on,
/// postures with frozen positions are left out.
Observations WithoutFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations);

/// "j4: its positions are 1.0292 +- 0.0004 times the true ones", "laser was moved by 5.1 +- 0.1 mm
/// at left.csv:26".
std::string DescribeFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations);

}  // namespace elastocal
