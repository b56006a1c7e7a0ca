// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/drafting/semantics.hpp"
#include "elastocal/drafting/soles.hpp"

namespace elastocal {

/// The posture of rest of a draft.
struct RestPosture {
  Eigen::VectorXd q;         ///< by coordinate, within the limits less a margin of 2 % of the range
  std::string source;        ///< in words: "the state 'half_sitting' of the SRDF"
  bool stands = false;       ///< all soles lie flat on one floor
  double root_height = 0.0;  ///< of the root link above the soles, m; 0 without soles
  std::vector<std::string> warnings = {};  ///< where the state of the SRDF breaks limits
};

inline constexpr double kUsualDrop = 0.06;  // of the legs' length

/// Chooses a posture of rest: a state of the SRDF (half sitting, standing, home, ...) if the robot
/// stands flat in it, otherwise the zero posture moved into the limits (without legs by 10
/// degrees more, or an eighth of the range), with the knees of the legs
/// bent: the root link is lowered by as much as the legs allow, up to the share `drop` of their
/// length. A share above the usual one bends the legs of a state of the SRDF too. `tree` has the
/// links of all soles.
RestPosture ChooseRest(const RobotTree& tree, const Limbs& limbs,
                       const std::vector<DraftedSole>& soles, const Semantics& semantics,
                       double drop = kUsualDrop);

/// PostureRange less a share of the range, by coordinate.
std::pair<Eigen::VectorXd, Eigen::VectorXd> RangesOf(const RobotTree& tree, double margin);

}  // namespace elastocal
