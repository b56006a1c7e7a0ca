// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "elastocal/observation/observation_figures.hpp"

namespace elastocal {

/// Computes the residual of each observation for a known robot.
using PredictObservations = std::function<std::vector<Eigen::VectorXd>(const Observations&)>;

/// Some observations of an instrument that are off, and the error of its others.
struct OffAlone {
  std::vector<int> observations;
  double rms_of_others = 0.0;  ///< root mean square error of the other observations, SI
};

/// The few observations of an instrument without which its others have an error of at most `most`
/// (root mean square, SI). In each round those at least half as far off as the worst are left out,
/// at most a quarter altogether. Empty where more would have to be left out, or where fewer than
/// four would remain.
OffAlone FindOffAlone(const ObservedRobot& model, const Observations& observations,
                      const RowErrors& row, double most, const PredictObservations& predict);

/// Positions of observations in their files, as text: "left.csv:7, 12, right.csv:3".
std::string PlacesOf(const std::vector<int>& some, const Observations& observations);

}  // namespace elastocal
