// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// What may be wrong with tables of observations beyond single rows.
enum class ObservationFaultKind {
  kJointGain,    ///< a joint's positions are a multiple of the true ones
  kJointOffset,  ///< a joint's positions are off by a constant from a posture on
  kJointDrift,   ///< they drift away steadily from the first posture to the last
  kJointFrozen,  ///< a joint's positions stay the same in some postures, where it moved
  kScale,        ///< lengths as measured in one of several files are a multiple of the true ones
  kTagSize,      ///< the project has a multiple of the true size of a tag, or of all
  kMoved,        ///< a tracker, a table, or what is measured on its link was moved
};

/// A fault that explains much of what the fit leaves.
struct ObservationFault {
  ObservationFaultKind kind = ObservationFaultKind::kJointGain;
  int coordinate = -1;  ///< of the robot tree
  int quantity = -1;    ///< of the setup: what was moved, or the place of a tag; -1: all tags
  int posture = 0;      ///< the first one that it is in
  int count = 0;        ///< of frozen positions: in how many postures
  int file = -1;        ///< of Observations::files, the only one that has it; -1: all
  /// Gain, scale or size of tags less 1; offset, or drift over all postures, rad or m; of a move,
  /// the displacement [m] or turn [rad] that explains most of it; 0 of frozen positions.
  double size = 0.0;
  double sd = 0.0;     ///< of `size`
  bool turns = false;  ///< of a move: `size` is an angle
  double share = 0.0;  ///< of the sum of squared residuals that it explains
};

/// The longest run of postures in which a joint is logged in exactly the same place; nothing where
/// it has fewer than five, or more than half of all.
std::optional<ObservationFault> FindFrozen(const Observations& observations, int coordinate);

/// Of a steady drift, what has come in a posture of so many.
double DriftedShare(int posture, int count);

/// Lets a quantity be another one from a posture on, in all that depends on it.
void AddEffect(const ObservedRobot& model, int quantity, int posture, Observations& observations);

/// How many numbers of a measurement, from the first on, are lengths that a wrong scale changes.
int LengthsMeasured(const Instrument& instrument);

/// Of what sees a tag, the quantity that places the tag; -1: it sees none.
int TagSeenBy(const Instrument& instrument);

/// The observations as a tag (-1: all) of `factor` times its size would give them.
Observations WithTagsLarger(const ObservedRobot& model, const Observations& observations, int tag,
                            double factor);

/// The observations as they would be without the fault: what was moved varies from there on,
/// postures with frozen positions are left out.
Observations WithoutFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations);

/// "j4: its positions are 1.0292 +- 0.0004 times the true ones", "laser was moved by some 5.1 mm
/// before left.csv:26", "size_mm of tag3 is 1.2490 +- 0.0021 times the true one".
std::string DescribeFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations);

}  // namespace elastocal
