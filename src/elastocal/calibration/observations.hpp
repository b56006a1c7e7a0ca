// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/noise.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// postures x markers: whether an observation takes part.
using ObservationMask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Mask of all observations that exist.
ObservationMask SeenMask(const Recording& recording);

/// The observations of one body's markers in one posture. Their residuals are expressed in an
/// orthonormal basis in which the sources of noise are independent: first the displacement of the
/// body, then its rotation about the centre of the markers, then changes of shape, which only the
/// noise of single markers causes.
struct BodyObservation {
  int posture = 0, body = 0;
  std::vector<int> markers;
  /// False for a marker that is left out; it then forms an observation by itself.
  bool used = true;
  Eigen::MatrixXd basis;  ///< 3 markers x 3 markers, orthonormal columns
  /// Factor by which the variance of the body's position enters each row of the basis.
  Eigen::ArrayXd by_position;
  Eigen::Index rotation_rows = 0;

  Eigen::Index size() const { return basis.cols(); }
  /// Number of rows that a displacement or rotation of the body affects; they come first.
  Eigen::Index shared_rows() const { return 3 + rotation_rows; }
  /// Variance of each row in the basis, m^2.
  Eigen::ArrayXd Variances(const Noise& noise, int group) const;
  /// Share of `source` in the variance of each row, 0 to 1.
  Eigen::ArrayXd Shares(const Noise& noise, int group, NoiseSource source) const;
  /// Number of postures for which each row counts, where `samples_each` moments tell as much of the
  /// shared displacement as one posture. The noise of single markers is independent from moment to
  /// moment.
  Eigen::ArrayXd Counts(const Noise& noise, int group, double samples_each) const;
};

/// `positions`: measured positions of the markers, 3 x markers, m.
BodyObservation MakeBodyObservation(int posture, int body, std::vector<int> markers,
                                    const Eigen::Matrix3Xd& positions);

/// Which observations and constraints take part in a fit.
struct Selection {
  ObservationMask markers;
  std::vector<char> tied;  ///< by posture: whether its support constraint takes part
  /// By posture and body. Then follow the seen markers that are left out, one by one.
  std::vector<BodyObservation> bodies;
};

/// Makes a selection of the given observations and support constraints.
Selection Select(const ErrorModel& model, const Recording& recording, ObservationMask markers,
                 std::vector<char> tied);

/// Selects all markers seen and all constraints.
Selection SelectAll(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
