// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/registration.hpp"

#include <vector>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

Transform RegisterWaist(const ErrorModel& model, const Recording& recording) {
  ErrorModel at_origin = model;
  at_origin.T_ref_waist = Transform::Identity();
  const Geometry geometry =
      ApplyErrors(at_origin, Eigen::VectorXd::Zero(at_origin.parameter_count()));
  std::vector<Eigen::Vector3d> nominal, measured;
  for (int i = 0; i < recording.posture_count(); ++i) {
    InterruptionPoint();
    const Eigen::Matrix3Xd p_waist_marker =
        MarkerPositions(at_origin, geometry, recording.q.row(i).transpose());
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (!Seen(recording, i, m)) continue;
      nominal.emplace_back(p_waist_marker.col(m));
      measured.push_back(MarkerPosition(recording, i, m));
    }
  }
  if (nominal.empty()) return Transform::Identity();
  using Points = Eigen::Map<const Eigen::Matrix3Xd>;
  const auto count = static_cast<Eigen::Index>(nominal.size());
  return FitRigid(Points(nominal[0].data(), 3, count), Points(measured[0].data(), 3, count));
}

}  // namespace elastocal
