// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/progress.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {

/// How far rows of one meaning are off, over all observations of an instrument.
struct RowErrors {
  int instrument = 0;
  std::string row;  ///< RowMeaning::name
  SourceUnit unit = SourceUnit::kNone;
  int observations = 0;
  double rms = 0.0;      ///< over observations and coordinates, SI
  double largest = 0.0;  ///< of one coordinate
};

/// How far touches are from lying flush, as root mean squares over touches.
struct TouchErrors {
  int touches = 0;
  double height = 0.0;  ///< m
  double tilt_x = 0.0;  ///< about the plate's own axes, rad
  double tilt_y = 0.0;
  double largest_height = 0.0;  ///< m

  double tilt() const;  ///< over both axes, rad: one number is one angle
};

/// Errors of all instruments that were read; of flush touches all together, and of each plate (0
/// touches: none).
struct ObservationFigures {
  TouchErrors all;
  std::vector<TouchErrors> by_plate;
  std::vector<RowErrors> rows;
};

/// `left`: of each observation, as LeftOf has it.
ObservationFigures MakeFigures(const ObservedRobot& model, const Observations& observations,
                               const std::vector<Eigen::VectorXd>& left);

/// Standard deviation of the noise of such rows, root mean square over them, SI.
double NoiseOf(const ObservedRobot& model, const RowErrors& row, const Spread& spread);

/// Observations that were predicted by an estimate from the others.
struct ObservationCrossValidation {
  int folds = 0;
  std::vector<Eigen::VectorXd> left;  ///< of each observation, SI
  ObservationFigures figures;
  int unsettled = 0;  ///< estimates whose variances did not come to rest
};

/// k-fold cross-validation: posture i is in fold i modulo `folds`. With each fold everything is
/// decided anew that an estimate decides. Throws InputError unless `folds` is from 2 to the number
/// of postures.
ObservationCrossValidation CrossValidate(const ObservedRobot& model,
                                         const Observations& observations,
                                         const ObservationFreedom& freedom, int folds, int threads,
                                         const Progress& progress = {});

/// Registers the surroundings (tables, trackers) anew on observations of another day, robot and
/// mountings staying as they are: each posture is predicted by surroundings that the others place,
/// with the effects of sessions that `spread` expects. A plate of fewer than four touches cannot be
/// judged: InputError.
std::vector<Eigen::VectorXd> LeftAfterRegistration(const ObservedRobot& model,
                                                   const Observations& observations,
                                                   const ObservedValues& values,
                                                   const Spread& spread);

/// More than what any calibrated robot is off by, root mean square, SI: 20 mm (of a robot larger
/// than 2 m, 1 % of RobotSize), 5 degrees, 0.5 m/s^2, 20 pixels.
double LargestError(const ObservedRobot& model, SourceUnit unit);

/// Whether observations are better explained by `after` than by `before`: mean over postures of the
/// difference in squared error, in units of its standard deviation (about normal for many
/// postures). Errors are in units of `spread`'s noise.
double GainInSds(const ObservedRobot& model, const Observations& observations,
                 const std::vector<Eigen::VectorXd>& before,
                 const std::vector<Eigen::VectorXd>& after, const Spread& spread);

}  // namespace elastocal
