// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A mistake in some postures of a table, and the table without it.
struct OddPostures {
  std::string what;  ///< in words, with the postures
  std::vector<int> postures;
  Recording corrected;
};

/// Postures of a table in which the placed nominal robot is far off (15 mm, or 1.5 % of a
/// small robot's size, and three times the median), while it is not in the others: a mistake in a
/// part of the table. The robot is placed by all postures, by either half or by either quarter of
/// the table, whichever leaves fewest postures far off. What is tried in each of these: the sign of
/// a joint; two joints exchanged; half a turn more or less of a joint; a joint's position, or all
/// markers, of the row before or after; labels of two clusters exchanged; another position of a
/// joint, as the markers tell it. The one that explains most of them (to less than half of the
/// distance, in three postures at least and in 0.6 of those far off), and then the one that
/// explains most of the others; empty where none does. A suspicion is no proof. Empty for a free
/// root and for recordings of trials. If the `errors` of the robot are known, 0.5 mm take the place
/// of 15 mm.
std::vector<OddPostures> FindOddPostures(const ErrorModel& model, const Recording& recording,
                                         const std::vector<LabelCluster>& clusters,
                                         const Eigen::VectorXd* errors = nullptr);

}  // namespace elastocal
