// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/noise.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// postures x markers: which observations take part.
using ObservationMask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Observations that are there at all.
ObservationMask SeenMask(const Recording& recording);

/// The markers of one body in one posture. What the model leaves unexplained of them is seen in an
/// orthonormal basis in which its sources are independent: first what a displacement of the body
/// would look like, then what a rotation about the markers' centre would, then changes of shape,
/// which only the noise of single markers can make.
struct BodyObservation {
  int posture = 0, body = 0;
  std::vector<int> markers;
  bool used = true;       ///< false: a marker that is left out, by itself
  Eigen::MatrixXd basis;  ///< 3 markers x as many, orthonormal columns
  /// By row in the basis: factor of the variance of the body's position in its own.
  Eigen::ArrayXd by_position;
  Eigen::Index rotation_rows = 0;

  Eigen::Index size() const { return basis.cols(); }
  /// Rows that a displacement or rotation of the body reaches; they come first.
  Eigen::Index shared_rows() const { return 3 + rotation_rows; }
  /// Variance of each row in the basis, m^2.
  Eigen::ArrayXd Variances(const Noise& noise, int group) const;
  /// Part of `source` in it: 0 to 1.
  Eigen::ArrayXd Shares(const Noise& noise, int group, NoiseSource source) const;
  /// As how many postures each row counts, where so many moments tell as much of the position's
  /// variance as one posture; noise of single markers is their own.
  Eigen::ArrayXd Counts(const Noise& noise, int group, double samples_each) const;
};

/// `positions`: of the markers, 3 x markers, m.
BodyObservation MakeBodyObservation(int posture, int body, std::vector<int> markers,
                                    const Eigen::Matrix3Xd& positions);

/// Which observations and constraints take part in a fit.
struct Selection {
  ObservationMask markers;
  std::vector<char> tied;  ///< by posture: whether its support constraint takes part
  /// By posture and body; then the markers seen that are left out, one by one.
  std::vector<BodyObservation> bodies;
};

Selection Select(const ErrorModel& model, const Recording& recording, ObservationMask markers,
                 std::vector<char> tied);

/// All markers seen, and all constraints.
Selection SelectAll(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
