// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Order of the postures that makes the whole tour short (paper section 3.6), from `start` through
/// all of them and back to it, by Euclidean distances. It improves the nearest-neighbour tours from
/// each of the stops, by reversing stretches (2-opt) and moving them elsewhere in either direction
/// (Or-opt) as long as a tour gets shorter, and takes the shortest. Deterministic.
std::vector<int> OrderPostures(const Eigen::VectorXd& start,
                               const std::vector<Eigen::VectorXd>& postures);

/// Length of the tour in this order.
double TourLength(const Eigen::VectorXd& start, const std::vector<Eigen::VectorXd>& postures,
                  const std::vector<int>& order);

}  // namespace elastocal
