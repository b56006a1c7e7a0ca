// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/progress.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// Errors of rows of one meaning, over all observations of an instrument.
struct RowErrors {
  int instrument = 0;
  std::string row;  ///< RowMeaning::name
  SourceUnit unit = SourceUnit::kNone;
  int observations = 0;
  double rms = 0.0;      ///< root mean square over observations and coordinates, SI
  double largest = 0.0;  ///< largest error of one coordinate
};

/// Deviation of touches from lying flush, as root mean squares over touches.
struct TouchErrors {
  int touches = 0;
  double height = 0.0;  ///< m
  double tilt_x = 0.0;  ///< about the plate's own axes, rad
  double tilt_y = 0.0;
  double largest_height = 0.0;  ///< m

  double tilt() const;  ///< over both axes, rad: each counts as one angle
};

/// Errors of all instruments that were read. Flush touches are given together, and for each plate
/// (0 touches: none).
struct ObservationFigures {
  TouchErrors all;
  std::vector<TouchErrors> by_plate;
  std::vector<RowErrors> rows;
};

/// `left` holds the residual of each observation, as from LeftOf.
ObservationFigures MakeFigures(const ObservedRobot& model, const Observations& observations,
                               const std::vector<Eigen::VectorXd>& left);

/// Standard deviation of the noise of these rows, root mean square over them, SI.
double NoiseOf(const ObservedRobot& model, const RowErrors& row, const Spread& spread);

/// Residuals of observations that were predicted by an estimate from the others.
struct ObservationCrossValidation {
  int folds = 0;
  std::vector<Eigen::VectorXd> left;  ///< residual of each observation, SI
  ObservationFigures figures;
  int unsettled = 0;  ///< number of estimates whose variances did not come to rest
};

/// k-fold cross-validation. Posture i is in fold i modulo `folds`. Each fold decides anew all that
/// an estimate decides. Throws InputError unless `folds` is from 2 to the number of postures.
ObservationCrossValidation CrossValidate(const ObservedRobot& model,
                                         const Observations& observations,
                                         const ObservationFreedom& freedom, int folds, int threads,
                                         const Progress& progress = {});

/// Residuals after the surroundings (tables, trackers) are registered anew on observations of
/// another day; robot and mountings stay unchanged. Each posture is predicted by surroundings that
/// the other postures place, with effects of sessions as wide as `spread`. Throws InputError for a
/// plate with fewer than four touches, which cannot be judged.
std::vector<Eigen::VectorXd> LeftAfterRegistration(const ObservedRobot& model,
                                                   const Observations& observations,
                                                   const ObservedValues& values,
                                                   const Spread& spread);

/// Error that no calibrated robot exceeds, root mean square, SI: 20 mm (1 % of RobotSize for a
/// robot larger than 2 m), 5 degrees, 0.5 m/s^2, 20 pixels.
double LargestError(const ObservedRobot& model, SourceUnit unit);

/// Gain of `after` over `before`: mean over postures of the difference in root mean square error,
/// divided by its standard deviation (about standard normal for many postures). Positive: `after`
/// explains the observations better. Errors are in units of the noise in `spread`. Errors count,
/// not their squares: in a single gross outlier, the squares of two models differ by more than in
/// all other postures, but the errors only by as much as the predictions do.
double GainInSds(const ObservedRobot& model, const Observations& observations,
                 const std::vector<Eigen::VectorXd>& before,
                 const std::vector<Eigen::VectorXd>& after, const Spread& spread);

}  // namespace elastocal
