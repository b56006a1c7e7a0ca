#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Order in which postures are visited so that the whole way is short (paper section 3.6): from
/// `start` through all of them and back to it, distances Euclidean. Of every tour to the nearest
/// neighbour, from each of the stops, stretches are reversed (2-opt) and moved elsewhere, either
/// way round (Or-opt), as long as that makes it shorter; the shortest is taken. Deterministic.
std::vector<int> OrderPostures(const Eigen::VectorXd& start,
                               const std::vector<Eigen::VectorXd>& postures);

/// Length of that way.
double TourLength(const Eigen::VectorXd& start, const std::vector<Eigen::VectorXd>& postures,
                  const std::vector<int>& order);

}  // namespace elastocal
