// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/leg_stiffness.hpp"

#include <cmath>
#include <limits>

#include "elastocal/calibration/static_torques.hpp"
#include "elastocal/robot/lumped_compliance.hpp"

namespace elastocal {
namespace {

/// The six compliances of a leg in a posture, along and about the axes of the foot.
Vector6d Compliances(const CalibrationResult& result, const Eigen::VectorXd& delta,
                     const Eigen::VectorXd& q, int leg) {
  return LumpedCompliance(result.model, ApplyErrors(result.model, delta), q, leg).diagonal();
}

/// Relative uncertainty of loads by statics alone: that of the masses in a robot description.
constexpr double kMassShare = 0.05;

/// Standard deviations of a leg's compliances. They contain the covariance of the parameters and
/// the relative uncertainty of the loads (a compliance is the deflection that the cameras saw over
/// the load). Compliances are linear in the parameters, so that a forward difference is exact.
Vector6d CompliancesSd(const CalibrationResult& result, const Eigen::VectorXd& q, int leg,
                       double load_share) {
  const std::vector<int>& parameters = result.posterior.parameters;
  const Vector6d at = Compliances(result, result.delta, q, leg);
  Eigen::MatrixXd by_parameter =
      Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(parameters.size()));
  Vector6d variance = Vector6d::Zero();
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const Parameter& parameter = result.model.parameters[parameters[k]];
    if (!IsCompliance(parameter.kind)) continue;
    Eigen::VectorXd beside = result.delta;
    const double step = ParameterScale(parameter);
    beside[parameters[k]] += step;
    const Vector6d slope = (Compliances(result, beside, q, leg) - at) / step;
    by_parameter.col(static_cast<Eigen::Index>(k)) = slope;
    variance += (load_share * result.delta[parameters[k]] * slope).cwiseAbs2();
  }
  variance +=
      (by_parameter * result.posterior.covariance).cwiseProduct(by_parameter).rowwise().sum();
  return variance.cwiseSqrt();
}

}  // namespace

std::vector<LegStiffness> AssessLegs(const CalibrationResult& result, const Recording& recording) {
  std::vector<LegStiffness> legs;
  if (!result.model.elasticity.base) return legs;
  for (int leg = 0; leg < result.model.leg_count(); ++leg) {
    LegStiffness entry;
    entry.leg = result.model.legs[leg].name;
    entry.q.setZero(recording.q.cols());
    int postures = 0;
    for (const Footing& footing : result.placement.footings) {
      if (footing.leg != leg) continue;
      for (int i : footing.postures) entry.q += recording.q.row(i).transpose();
      postures += static_cast<int>(footing.postures.size());
    }
    if (postures == 0) continue;
    entry.q /= postures;
    for (int k : result.model.legs[leg].joints) {
      const Joint& joint = result.model.tree.joints[k];
      entry.posture.emplace_back(joint.name, JointPosition(joint, entry.q));
    }
    const Vector6d compliance = Compliances(result, result.delta, entry.q, leg);
    const double disagreement = TorqueDisagreement(result.model, recording, result.placement, leg);
    entry.load_share = std::isfinite(disagreement) ? disagreement : kMassShare;
    const Vector6d half =
        result.interval_factor * CompliancesSd(result, entry.q, leg, entry.load_share);
    entry.stiffness = compliance.cwiseInverse();
    entry.low = (compliance + half).cwiseInverse();
    for (int axis = 0; axis < 6; ++axis) {
      const double least = compliance[axis] - half[axis];
      entry.high[axis] = least > 0.0 ? 1.0 / least : std::numeric_limits<double>::infinity();
    }
    legs.push_back(std::move(entry));
  }
  return legs;
}

}  // namespace elastocal
