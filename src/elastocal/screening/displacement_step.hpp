// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/measurement/labels.hpp"

namespace elastocal {

/// A cluster whose position on its link changes at some posture.
struct DisplacementStep {
  int cluster = -1;     ///< index of the given clusters; -1: no step explains anything
  int posture = 0;      ///< the first posture after the step in which the cluster was seen
  int last_before = 0;  ///< the last posture before the step in which the cluster was seen
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< in the axes of the link, m
  double gain = 0.0;          ///< decrease of the sum of squared residuals
  double significance = 0.0;  ///< F statistic of the step over the value that chance would reach
  double scatter = 0.0;       ///< scatter of the cluster about its mean on either side, m per axis
};

/// Finds the displacement of one of the clusters, between any two postures, that explains most of
/// the residuals of a least-squares fit to a recording of trials. With residuals r, derivatives J
/// by all unknowns of the fit and A by the displacement, the score test (Rao 1948) uses the
/// projection P on what J leaves unexplained:
///
///   displacement = (A' P A)^-1 A' P r,   gain = r' P A (A' P A)^-1 A' P r
///
/// The displacement is thus not confused with what joints, markers, feet or the waist of a posture
/// explain as well. Directions in which it is hardly known (standard deviation above 0.5 mm) are
/// left out, because errors of the model would appear as a step of millimetres. At least three
/// postures are on either side of a step. Within three postures of a change of feet the loads
/// change suddenly, so that errors of the loads would appear as a step. There, P must leave at
/// least a twentieth of the information that remains if only the cluster's position on its link is
/// unknown.
///
/// `significance` is gain / 3 over the variance that is left, divided by the quantile of Fisher's F
/// that chance exceeds with `probability` in any of the steps tried. `free` holds the fitted
/// parameters. The fit's posterior must be up to date, and the support form kNuisance.
DisplacementStep FindLargestStep(const FitProblem& problem, const Selection& selection,
                                 const std::vector<int>& free, const Fit& fit,
                                 const std::vector<LabelCluster>& clusters, double probability);

}  // namespace elastocal
