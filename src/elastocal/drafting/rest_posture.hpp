// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/drafting/semantics.hpp"
#include "elastocal/drafting/soles.hpp"

namespace elastocal {

/// Drafted posture of rest.
struct RestPosture {
  Eigen::VectorXd q;    ///< by coordinate, within the limits minus a margin of 2 % of the range
  std::string source;   ///< origin as text: "the state 'half_sitting' of the SRDF"
  bool stands = false;  ///< all soles lie flat on one floor
  double root_height = 0.0;  ///< height of the root link above the soles, m; 0 without soles
  std::vector<std::string> warnings = {};  ///< warnings where the state of the SRDF exceeds limits
};

inline constexpr double kUsualDrop = 0.06;  // share of the legs' length

/// Chooses a posture of rest: a state of the SRDF (half sitting, standing, home, ...) if the robot
/// stands flat in it. Otherwise it is the zero posture moved into the limits (without legs by
/// another 10 degrees, or an eighth of the range), with bent knees: the root link is lowered as far
/// as the legs allow, by at most the share `drop` of their length. A share above the usual one also
/// bends the legs of a state of the SRDF. `tree` must have the links of all soles.
RestPosture ChooseRest(const RobotTree& tree, const Limbs& limbs,
                       const std::vector<DraftedSole>& soles, const Semantics& semantics,
                       double drop = kUsualDrop);

/// PostureRange minus a share of the range, by coordinate.
std::pair<Eigen::VectorXd, Eigen::VectorXd> RangesOf(const RobotTree& tree, double margin);

}  // namespace elastocal
