// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/registration.hpp"

#include <vector>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// Computes nominal marker positions in the waist, and pairs them with the measured ones.
class NominalMarkers {
 public:
  NominalMarkers(const ErrorModel& model, const Recording& recording)
      : model_(model), recording_(recording) {
    model_.T_ref_waist = Transform::Identity();
    geometry_ = ApplyErrors(model_, Eigen::VectorXd::Zero(model_.parameter_count()));
  }

  void Add(int posture, Points& nominal, Points& measured) const {
    InterruptionPoint();
    const Eigen::Matrix3Xd p_waist_marker =
        MarkerPositions(model_, geometry_, recording_.q.row(posture).transpose());
    for (int m = 0; m < recording_.marker_count(); ++m) {
      if (!Seen(recording_, posture, m)) continue;
      nominal.emplace_back(p_waist_marker.col(m));
      measured.push_back(MarkerPosition(recording_, posture, m));
    }
  }

 private:
  ErrorModel model_;  // with the waist at the origin
  const Recording& recording_;
  Geometry geometry_;
};

}  // namespace

Transform RegisterWaist(const ErrorModel& model, const Recording& recording) {
  const NominalMarkers markers(model, recording);
  Points nominal, measured;
  for (int i = 0; i < recording.posture_count(); ++i) markers.Add(i, nominal, measured);
  return FitRigid(nominal, measured).value_or(Transform::Identity());
}

std::vector<std::optional<Transform>> RegisterWaistByPosture(const ErrorModel& model,
                                                             const Recording& recording) {
  const NominalMarkers markers(model, recording);
  std::vector<std::optional<Transform>> poses;
  for (int i = 0; i < recording.posture_count(); ++i) {
    Points nominal, measured;
    markers.Add(i, nominal, measured);
    poses.push_back(FitRigid(nominal, measured));
  }
  return poses;
}

}  // namespace elastocal
