// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/calibration/linear_study.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// Corrections that observations can show: those of joints and, where the root link is held still
/// (no feet), those of its suspension and of loads. (Feet place the root link anew in each
/// posture.)
std::vector<Correction> ObservableCorrections(const RobotTree& tree, const ObservationSetup& setup);

/// The same robot with exactly these corrections.
ObservedRobot WithCorrections(const ObservedRobot& model, const PlacementOptions& placement,
                              const Observations& observations,
                              const std::vector<Correction>& corrections);

/// A fit to observations, linearised at its solution, with a column for every correction of `wide`
/// (WithCorrections of `model`, the model of the fit) that `model` lacks. Noise, weights and the
/// widths of the priors stay unchanged. Errors are in units of the noise, because observations are
/// of several kinds.
LinearStudy MakeObservedStudy(const ObservedRobot& wide, const ObservedRobot& model,
                              const Observations& observations, const ObservationFit& fit);

/// The values of `model`, expressed in `wide`.
ObservedValues ValuesOfWide(const ObservedRobot& wide, const ObservedRobot& model,
                            const ObservedValues& values);

}  // namespace elastocal
