// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/observation/observed_robot.hpp"

namespace elastocal {

/// Faults in tables of observations that concern more than single rows.
enum class ObservationFaultKind {
  kJointGain,    ///< positions of a joint are a multiple of the true ones
  kJointOffset,  ///< positions of a joint have a constant offset from some posture on
  kJointDrift,   ///< positions of a joint drift steadily from the first posture to the last
  kJointFrozen,  ///< positions of a joint stay the same in some postures although it moved
  kScale,        ///< lengths measured in one of several files are a multiple of the true ones
  kTagSize,  ///< the size of a tag, or of all tags, in the project is a multiple of the true one
  kMoved,    ///< a tracker, a table, or what is measured on its link was displaced
};

/// A fault that explains much of the residuals of a fit.
struct ObservationFault {
  ObservationFaultKind kind = ObservationFaultKind::kJointGain;
  int coordinate = -1;  ///< joint's coordinate in the robot tree
  /// Quantity of the setup that was displaced, or that places the tag; -1: all tags.
  int quantity = -1;
  int posture = 0;  ///< first posture with the fault
  int count = 0;    ///< of frozen positions: number of postures
  int file = -1;    ///< index in Observations::files of the only file with the fault; -1: all
  /// Gain, scale or size of tags minus 1; offset, or drift over all postures, rad or m; of a
  /// displacement, the translation [m] or rotation [rad] that explains most of it; 0 for frozen
  /// positions.
  double size = 0.0;
  double sd = 0.0;     ///< standard deviation of `size`
  bool turns = false;  ///< of a displacement: `size` is an angle
  double share = 0.0;  ///< share of the sum of squared residuals that it explains
};

/// The longest run of consecutive postures with exactly the same logged position of a joint.
/// Nothing where it has fewer than five postures, or more than half of all.
std::optional<ObservationFault> FindFrozen(const Observations& observations, int coordinate);

/// Share of a steady drift that has accumulated at `posture` of `count` postures.
double DriftedShare(int posture, int count);

/// Gives a quantity an effect from a posture on, in all observations that depend on it.
void AddEffect(const ObservedRobot& model, int quantity, int posture, Observations& observations);

/// Number of leading numbers of a measurement that are lengths, which a wrong scale changes.
int LengthsMeasured(const Instrument& instrument);

/// Quantity that places the tag that an instrument sees; -1: it sees none.
int TagSeenBy(const Instrument& instrument);

/// The observations as a tag (-1: all tags) of `factor` times its size would give them.
Observations WithTagsLarger(const ObservedRobot& model, const Observations& observations, int tag,
                            double factor);

/// The observations as they would be without the fault: what was moved varies from there on,
/// postures with frozen positions are left out.
Observations WithoutFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations);

/// A fault as text: "j4: its positions are 1.0292 +- 0.0004 times the true ones", "laser was moved
/// by some 5.1 mm before left.csv:26", "size_mm of tag3 is 1.2490 +- 0.0021 times the true one".
std::string DescribeFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations);

}  // namespace elastocal
