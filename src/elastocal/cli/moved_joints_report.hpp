// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/validation/moved_joints.hpp"

namespace elastocal::cli {

/// The result of `check` on joints: those that have moved and by how much, or those of which one
/// may have moved, and the `alternatives` that explain it equally well. "Unchanged: ..." with the
/// probability of a false alarm (`level`) where none has moved.
std::string DescribeMoved(const JointCheck& check, const std::vector<std::string>& alternatives,
                          double level);

/// The result if the alternatives explain it better.
std::string DescribeWrongRecording(const std::vector<std::string>& alternatives);

/// Table of the joints that may have moved, the most probable first.
std::string SuspectTable(const JointCheck& check);

/// A probability in the form used in tables.
std::string Probability(double p);

/// Text that says on how many links the markers stayed, and on which they did not.
std::string DescribeMarkers(const std::vector<LinkMarkers>& links);

/// Text on the smallest change of a joint's zero that these postures show, and on joints of which
/// they show none.
std::string DescribeSensitivity(const JointCheck& check);

}  // namespace elastocal::cli
