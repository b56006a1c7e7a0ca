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
///     rows:+1                  what was observed belongs to the joint positions of the next row
///     labels:NAME,NAME         what two instruments measured (two bodies, two tags) is exchanged
///     sign:JOINT@FILE          in this file alone; so exchange, rows and labels
///     sign:JOINT@FILE:14       from the fourteenth posture of this file on; so the others
///     frozen:JOINT             its positions stay the same in some rows, which are left out
///     gain:JOINT=1.03          the joint's positions are 1.03 times the true ones
///     gain:JOINT@FILE=1.03     in this file alone
///     offset:JOINT@FILE:14=2   they are 2 deg (of a sliding joint: mm) too large from the
///                              fourteenth posture of this file on; without :14, in all of it
///     scale=1.02               positions and lengths as measured are 1.02 times the true ones
///     scale:FILE=1.02          in this file alone
///
/// All but `frozen` are done as they say. Returns what was undone, in words. Throws InputError for
/// other names, joints or files that are not there, sizes that no fault has
/// (ParseStatedCorrection), a scale where nothing measures lengths, and joints that are not frozen
/// anywhere.
std::vector<std::string> CorrectObservations(const std::vector<std::string>& accepted,
                                             const ObservedRobot& model,
                                             Observations& observations);

/// What these names call a file: without its folder.
std::string NameInAccept(const std::string& file);

/// The name that undoes a fault. Nothing for what was moved: rows from there on belong into a file
/// of their own; nor for sizes of tags, which are corrected in the project.
std::optional<std::string> NameOfFault(const ObservationFault& fault, const ObservedRobot& model,
                                       const Observations& observations);

/// Which postures belong to a file, from one of its postures on (counted from 1); to all files
/// where `file` is empty.
std::vector<char> PosturesOf(const Observations& observations, const std::string& file, int from);

/// What was observed in each posture of `here`, with the joint positions of another one, so many
/// rows further in the same file; postures without such a row are left out.
Observations WithRowsOf(const Observations& observations, int further,
                        const std::vector<char>& here);

/// Whether two instruments are of one kind, so that what they measured can be exchanged. Touches
/// measure nothing.
bool MeasureAlike(const ObservedRobot& model, int a, int b);

/// With what two instruments that measure alike showed exchanged in the postures of `here`.
Observations WithLabelsExchanged(const Observations& observations, int a, int b,
                                 const std::vector<char>& here);

}  // namespace elastocal
