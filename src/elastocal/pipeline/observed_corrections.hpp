// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/observation/observation_fault.hpp"

namespace elastocal {

/// What `--accept` undoes in tables of observations:
///
///     sign:JOINT               the sign of the joint's positions is reversed
///     exchange:JOINT,JOINT     the positions of two joints are exchanged
///     frozen:JOINT             its positions stay the same in some rows, which are left out
///     rows:+1                  what was observed belongs to the joint positions of the next row
///     gain:JOINT=1.03          the joint's positions are 1.03 times the true ones
///     gain:JOINT@FILE=1.03     in this file alone
///     offset:JOINT@FILE:14=2   they are 2 deg (of a sliding joint: mm) too large from the
///                              fourteenth posture of this file on; without :14, in all of it
///     scale=1.02               positions and lengths as measured are 1.02 times the true ones
///     scale:FILE=1.02          in this file alone
///
/// All but `frozen` are done as they say. Returns what was undone, in words. Throws InputError for
/// other names, joints or files that are not there, sizes that no fault has
/// (ParseStatedCorrection), and joints that are not frozen anywhere.
std::vector<std::string> CorrectObservations(const std::vector<std::string>& accepted,
                                             const ObservedRobot& model,
                                             Observations& observations);

/// The name that undoes a fault. Nothing for what was moved: rows from there on belong into a file
/// of their own.
std::optional<std::string> NameOfFault(const ObservationFault& fault, const ObservedRobot& model,
                                       const Observations& observations);

/// What was observed in each posture, with the joint positions of another one, so many rows further
/// in the same file; postures without such a row are left out.
Observations WithRowsOf(const Observations& observations, int further);

}  // namespace elastocal
