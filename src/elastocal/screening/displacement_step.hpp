// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/measurement/labels.hpp"

namespace elastocal {

/// A cluster of markers that is elsewhere on its link from some posture on.
struct DisplacementStep {
  int cluster = -1;     ///< index of those given; -1: none explains anything
  int posture = 0;      ///< the first one after it in which the cluster was seen
  int last_before = 0;  ///< the last one before it in which the cluster was seen
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< in the axes of the link, m
  double gain = 0.0;          ///< by which the sum of squared residuals would drop
  double significance = 0.0;  ///< its F statistic over that which chance would reach
  double scatter = 0.0;       ///< of the cluster about its mean on either side, m per axis
};

/// The displacement of one of the clusters, between any two postures, that would explain most of
/// what a least-squares fit to all of a recording of trials has left. With residuals r, derivatives
/// J by all unknowns of the fit and A by the displacement, the score test (Rao 1948): let P project
/// on what J leaves unexplained; then
///
///   displacement = (A' P A)^-1 A' P r,   gain = r' P A (A' P A)^-1 A' P r
///
/// so that the displacement is not confused with what joints, markers, feet or the waist of a
/// posture could explain as well. Directions in which it is hardly known (a standard deviation
/// above 0.5 mm) are not looked at, as errors of the model would seem a step of millimetres. Where
/// the robot changes its feet, within three postures, loads change as suddenly as a cluster that is
/// knocked moves: what wrong loads bend would seem a step. There, P must leave a twentieth of the
/// information that there is if nothing else is unknown but where the cluster is on its link. No
/// side of a step has fewer than three postures.
///
/// `significance`: gain / 3 over what variance is left, over the quantile of Fisher's F that chance
/// exceeds with `probability` in any of the steps tried.
/// `free`: the parameters fitted. The fit's posterior must be up to date; in the form kNuisance.
DisplacementStep FindLargestStep(const FitProblem& problem, const Selection& selection,
                                 const std::vector<int>& free, const Fit& fit,
                                 const std::vector<LabelCluster>& clusters, double probability);

}  // namespace elastocal
