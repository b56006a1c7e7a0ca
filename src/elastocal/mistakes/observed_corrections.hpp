// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/observation/observation_fault.hpp"

namespace elastocal {

/// Corrections that `--accept` makes in tables of observations:
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
/// All but `frozen` are made as they say. Returns descriptions of the corrections. Throws
/// InputError for other names, for joints or files that do not exist, for sizes that no fault has
/// (ParseStatedCorrection), for a scale where nothing measures lengths, and for joints that are
/// frozen nowhere.
std::vector<std::string> CorrectObservations(const std::vector<std::string>& accepted,
                                             const ObservedRobot& model,
                                             Observations& observations);

/// Name of a file in `--accept`: without its folder.
std::string NameInAccept(const std::string& file);

/// The name that corrects a fault. Nothing for a displacement, because rows from there on belong
/// into their own file, and for sizes of tags, which are corrected in the project.
std::optional<std::string> NameOfFault(const ObservationFault& fault, const ObservedRobot& model,
                                       const Observations& observations);

/// For each posture: whether it belongs to a file, from one of the file's postures on (counted from
/// 1); to any file where `file` is empty.
std::vector<char> PosturesOf(const Observations& observations, const std::string& file, int from);

/// The observations in each posture of `here`, with the joint positions of the row `further` rows
/// later in the same file. Postures without such a row are left out.
Observations WithRowsOf(const Observations& observations, int further,
                        const std::vector<char>& here);

/// Whether two instruments are of one kind, so that their measurements can be exchanged. Touches
/// measure nothing.
bool MeasureAlike(const ObservedRobot& model, int a, int b);

/// The observations with the measurements of two similar instruments exchanged in the postures of
/// `here`.
Observations WithLabelsExchanged(const Observations& observations, int a, int b,
                                 const std::vector<char>& here);

}  // namespace elastocal
