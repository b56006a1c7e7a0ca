// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/observation/observation_figures.hpp"

namespace elastocal {

/// What is left of each observation by a robot that is known.
using PredictObservations = std::function<std::vector<Eigen::VectorXd>(const Observations&)>;

/// Some observations of an instrument, and how far its others are off.
struct OffAlone {
  std::vector<int> observations;
  double rms_of_others = 0.0;  ///< SI
};

/// The few observations of an instrument to leave out so that its others are off by no more than
/// `most` (root mean square, SI), the worst first: at most a quarter of them. None where more would
/// have to go, or where fewer than four would be left.
OffAlone FindOffAlone(const ObservedRobot& model, const Observations& observations,
                      const RowErrors& row, double most, const PredictObservations& predict);

/// "left.csv:7, 12, right.csv:3": where observations are.
std::string PlacesOf(const std::vector<int>& some, const Observations& observations);

}  // namespace elastocal
