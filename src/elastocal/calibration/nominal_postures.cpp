// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/nominal_postures.hpp"

#include <algorithm>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

std::vector<NominalPosture> NominalPostures(const ErrorModel& model, const Recording& recording,
                                            int trial, std::size_t most) {
  std::vector<int> all;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (trial < 0 || recording.trial[i] == trial) all.push_back(i);
  }
  ErrorModel at_origin = model;
  at_origin.T_ref_waist = Transform::Identity();
  const Geometry geometry =
      ApplyErrors(at_origin, Eigen::VectorXd::Zero(at_origin.parameter_count()));
  std::vector<NominalPosture> postures;
  const std::size_t stride = 1 + all.size() / most;
  for (std::size_t k = 0; k < all.size(); k += stride) {
    postures.push_back(
        {all[k], MarkerPositions(at_origin, geometry, recording.q.row(all[k]).transpose())});
  }
  return postures;
}

std::optional<Transform> PlaceRoot(const Recording& recording, const NominalPosture& nominal,
                                   const std::vector<int>& without) {
  constexpr int kLeastMarkers = 3;
  Eigen::Matrix3Xd from(3, recording.marker_count()), to(3, recording.marker_count());
  int count = 0;
  for (int m = 0; m < recording.marker_count(); ++m) {
    const bool left_out = std::find(without.begin(), without.end(), m) != without.end();
    if (left_out || !Seen(recording, nominal.posture, m)) continue;
    from.col(count) = nominal.markers.col(m);
    to.col(count++) = MarkerPosition(recording, nominal.posture, m);
  }
  if (count < kLeastMarkers) return std::nullopt;
  return FitRigid(from.leftCols(count), to.leftCols(count));
}

}  // namespace elastocal
