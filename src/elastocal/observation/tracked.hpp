// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// Instruments whose numbers are in the frame of a tracker (cameras of a motion capture system, a
/// laser tracker). The tracker stands on the floor or is carried by a link. Their first quantity is
/// the pose of the tracker's frame on the floor or in that link, which is then the second of
/// `links`.

/// Position of a point (a marker, a reflector) of a link. It measures x, y, z, m.
///
/// Quantities: the tracker's pose; the position of the point on its link, as displacement from the
/// origin [m].
class TrackedPoint : public Instrument {
 public:
  const char* kind() const override { return "position"; }
  std::vector<RowMeaning> rows() const override {
    return std::vector<RowMeaning>(3, {"position", SourceUnit::kMetre});
  }
  int measured_size() const override { return 3; }
  ObservationResidual Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const override;
  Eigen::VectorXd Predict(const Sight& sight) const override;
  void AddLandmarks(const Sight& sight, const Eigen::VectorXd& measured,
                    Landmarks& landmarks) const override;
};

/// Pose of a rigid body that is fixed to a link. It measures the position [m] and the unit
/// quaternion x, y, z, w. The residual is the position in the tracker's axes [m], then the rotation
/// vector from the measured to the predicted attitude in the body's axes [rad].
///
/// Quantities: the tracker's pose; the body's pose in the link.
class TrackedBody : public Instrument {
 public:
  const char* kind() const override { return "pose"; }
  std::vector<RowMeaning> rows() const override;
  int measured_size() const override { return 7; }
  ObservationResidual Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const override;
  Eigen::VectorXd Predict(const Sight& sight) const override;
  void AddLandmarks(const Sight& sight, const Eigen::VectorXd& measured,
                    Landmarks& landmarks) const override;
};

}  // namespace elastocal
