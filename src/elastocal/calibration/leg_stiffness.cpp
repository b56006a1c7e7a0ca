#include "elastocal/calibration/leg_stiffness.hpp"

#include "elastocal/robot/lumped_compliance.hpp"

namespace elastocal {

std::vector<LegStiffness> AssessLegs(const CalibrationResult& result, const Recording& recording) {
  std::vector<LegStiffness> legs;
  const Geometry geometry = ApplyErrors(result.model, result.delta);
  for (int leg = 0; leg < result.model.leg_count(); ++leg) {
    LegStiffness entry{result.model.legs[leg].name, Eigen::VectorXd::Zero(recording.q.cols())};
    int postures = 0;
    for (const Footing& footing : result.placement.footings) {
      if (footing.leg != leg) continue;
      for (int i : footing.postures) entry.q += recording.q.row(i).transpose();
      postures += static_cast<int>(footing.postures.size());
    }
    if (postures == 0) continue;
    entry.q /= postures;
    entry.stiffness =
        LumpedCompliance(result.model, geometry, entry.q, leg).diagonal().cwiseInverse();
    legs.push_back(std::move(entry));
  }
  return legs;
}

}  // namespace elastocal
