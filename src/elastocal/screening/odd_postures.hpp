// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A mistake in some postures of a table, and the corrected table.
struct OddPostures {
  std::string what;  ///< the mistake in words, with the postures
  std::vector<int> postures;
  Recording corrected;
};

/// Finds mistakes in a part of a posture table: postures in which the placed nominal robot is far
/// off, while it is not in the others. Far off means at least 15 mm (1.5 % of a small robot's size)
/// and three times the median. The robot is placed by all postures, by either half or by either
/// quarter of the table, whichever leaves the fewest postures far off.
///
/// In each of these postures the following mistakes are tried: a reversed sign of a joint; two
/// joints exchanged; half a turn more or less of a joint; a joint's position, or all markers, of
/// the row before or after; labels of two clusters exchanged; another position of a joint, as the
/// markers show it. The mistake that explains most of these postures is returned, then the one that
/// explains most of the others; a mistake explains a posture if it leaves less than half of the
/// distance. It must explain at least three postures and 0.6 of those far off. A suspicion is no
/// proof. Empty where no mistake explains them, for a free root and for recordings of trials. With
/// known `errors` of the robot, the limit is 0.5 mm instead of 15 mm.
std::vector<OddPostures> FindOddPostures(const ErrorModel& model, const Recording& recording,
                                         const std::vector<LabelCluster>& clusters,
                                         const Eigen::VectorXd* errors = nullptr);

}  // namespace elastocal
