// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/calibration/linear_study.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// The corrections that observations may show: of joints; where the root link is held still (no
/// feet), also its suspension and what loads the joints. (Feet place the root link anew in each
/// posture.)
std::vector<Correction> ObservableCorrections(const RobotTree& tree, const ObservationSetup& setup);

/// The same robot with these corrections, and no others.
ObservedRobot WithCorrections(const ObservedRobot& model, const PlacementOptions& placement,
                              const Observations& observations,
                              const std::vector<Correction>& corrections);

/// A fit to observations, linearised where it ended, with a column for every correction that `wide`
/// (WithCorrections of `model`, the model of the fit) has and `model` has not. Noise, weights and
/// the widths of the priors stay as they were. Errors are in units of the noise, because
/// observations are of several kinds.
LinearStudy MakeObservedStudy(const ObservedRobot& wide, const ObservedRobot& model,
                              const Observations& observations, const ObservationFit& fit);

/// Values of `model` as those of `wide`.
ObservedValues ValuesOfWide(const ObservedRobot& wide, const ObservedRobot& model,
                            const ObservedValues& values);

}  // namespace elastocal
