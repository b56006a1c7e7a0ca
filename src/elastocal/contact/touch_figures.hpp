#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/contact/contact_fit.hpp"
#include "elastocal/math/progress.hpp"

namespace elastocal {

/// How far touches are from lying flush, as root mean squares over touches.
struct TouchErrors {
  int touches = 0;
  double height = 0.0;  ///< m
  double tilt_x = 0.0;  ///< about the plate's own axes, rad
  double tilt_y = 0.0;
  double largest_height = 0.0;  ///< m

  double tilt() const;  ///< over both axes, rad: one number is one angle
};

/// Errors over all touches, and of each plate (0 touches: none).
struct TouchFigures {
  TouchErrors all;
  std::vector<TouchErrors> by_plate;
};

/// `left`: of each touch, as LeftOfTouches has it.
TouchFigures MakeFigures(const ContactModel& model, const Touches& touches,
                         const Eigen::MatrixX3d& left);

/// Touches that were predicted by an estimate from the others.
struct TouchCrossValidation {
  int folds = 0;
  Eigen::MatrixX3d left;  ///< of each touch, m and rad
  TouchFigures figures;
  int unsettled = 0;  ///< estimates whose variances did not come to rest
};

/// k-fold cross-validation: touch i is in fold i modulo `folds`. With each fold everything is
/// decided anew that an estimate decides. Throws InputError unless `folds` is from 2 to the number
/// of touches.
TouchCrossValidation CrossValidateTouches(const ContactModel& model, const Touches& touches,
                                          const ContactFreedom& freedom, int folds, int threads,
                                          const Progress& progress = {});

/// Registers the tables anew on touches of another day, robot and plates staying as they are: each
/// touch is predicted by tables that the others of its plate place, with the effects of sessions
/// that `spread` expects. A table seen by fewer than four touches cannot be judged: InputError.
Eigen::MatrixX3d LeftAfterRegistration(const ContactModel& model, const Touches& touches,
                                       const ContactValues& values, const ContactSpread& spread);

/// Whether touches are better explained by `after` than by `before`: mean over touches of the
/// difference in squared error, in units of its standard deviation (about normal for many touches).
/// Errors are in units of `spread`'s noise.
double GainInSds(const Eigen::MatrixX3d& before, const Eigen::MatrixX3d& after,
                 const ContactSpread& spread);

}  // namespace elastocal
