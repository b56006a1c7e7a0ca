// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/validation/moved_joints.hpp"

namespace elastocal::cli {

/// What `check` says of joints: those that have moved and by how much, or which one of several may
/// have, and the `alternatives` that explain it as well; "Unchanged: ..." with the chance of a
/// false alarm (`level`) where none has.
std::string DescribeMoved(const JointCheck& check, const std::vector<std::string>& alternatives,
                          double level);

/// What is said instead where the alternatives explain it better.
std::string DescribeWrongRecording(const std::vector<std::string>& alternatives);

/// The joints that may have moved, the most probable first.
std::string SuspectTable(const JointCheck& check);

/// A probability as tables have it.
std::string Probability(double p);

/// On how many links the markers stayed, and on which they did not.
std::string DescribeMarkers(const std::vector<LinkMarkers>& links);

/// How small a change of a joint's zero these postures show, and joints of which they show none.
std::string DescribeSensitivity(const JointCheck& check);

}  // namespace elastocal::cli
