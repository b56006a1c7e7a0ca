// SPDX-License-Identifier: Apache-2.0
#include "elastocal/exports/runtime_causes.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/corrections.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

/// The function of the posture by which a correction displaces a joint; nothing where it depends on
/// more than motion and loads.
std::optional<int> ShiftFunction(CorrectionShape shape) {
  switch (shape) {
    case CorrectionShape::kSin:
      return EC_SIN;
    case CorrectionShape::kCos:
      return EC_COS;
    case CorrectionShape::kSinTwice:
      return EC_SIN_TWICE;
    case CorrectionShape::kCosTwice:
      return EC_COS_TWICE;
    case CorrectionShape::kGear:
    case CorrectionShape::kCoupling:
      return EC_GEAR;
    case CorrectionShape::kBacklash:
      return EC_BACKLASH;
    case CorrectionShape::kStiffening:
      return EC_STIFFENING;
    case CorrectionShape::kHysteresis:
      return EC_HYSTERESIS;
    default:
      return std::nullopt;
  }
}

/// Applies a correction of weights: a mass acts at the body's nominal centre, a first moment along
/// an axis of the link on its joint.
void CorrectWeights(const RobotTree& tree, const Correction& correction, double value,
                    RuntimeModel& model) {
  if (correction.shape == CorrectionShape::kGravityTilt) {
    const Eigen::Vector3d gravity(model.gravity[0], model.gravity[1], model.gravity[2]);
    const Eigen::Vector3d by = value * Eigen::Vector3d::Unit(correction.axis).cross(gravity);
    for (int i = 0; i < 3; ++i) model.gravity[Size(i)] += by[i];
    return;
  }
  const auto body = Size(correction.source + 1);
  Eigen::Vector3d added =
      tree.links[Size(tree.joints[Size(correction.source)].child_link)].T_body_link.linear().col(
          std::max(0, correction.axis));
  if (correction.shape == CorrectionShape::kMass) {
    for (int i = 0; i < 3; ++i) added[i] = model.moment[3 * body + Size(i)] / model.mass[body];
    model.mass[body] += value;
  }
  for (int i = 0; i < 3; ++i) model.moment[3 * body + Size(i)] += value * added[i];
}

/// Whether the correction depends on motion and loads only.
bool IsAtRunTime(const Correction& correction) {
  const CorrectionTarget target = TargetOf(correction);
  return target == CorrectionTarget::kLoads || target == CorrectionTarget::kRoot ||
         ShiftFunction(correction.shape).has_value();
}

struct FoundCause {
  Correction correction;
  double size = 0.0;
};

/// The corrections that a calibration has.
std::vector<FoundCause> FoundCauses(const RobotTree& tree, const StoredCalibration& calibration) {
  std::vector<FoundCause> causes;
  for (const Correction& correction : PossibleCorrections(tree, std::nullopt)) {
    const auto found = calibration.joint_errors.find(correction.name);
    if (found == calibration.joint_errors.end() || found->second == 0.0) continue;
    causes.push_back({correction, found->second});
  }
  return causes;
}

}  // namespace

void ApplyCauses(const RobotTree& tree, const StoredCalibration& calibration, RuntimeModel& model) {
  for (const auto& [correction, size] : FoundCauses(tree, calibration)) {
    if (TargetOf(correction) == CorrectionTarget::kLoads) {
      CorrectWeights(tree, correction, size, model);
    }
    if (TargetOf(correction) == CorrectionTarget::kRoot) {
      const bool about_y = correction.shape == CorrectionShape::kSuspensionMy;
      model.suspension[Size(correction.axis + (about_y ? 6 : 0))] = size;
    }
    const auto function = ShiftFunction(correction.shape);
    if (!function) continue;
    model.shifts.push_back({correction.joint, *function,
                            correction.source >= 0 ? correction.source : correction.joint, size,
                            correction.centre, LoadScale(tree, correction)});
  }
}

std::set<std::string> CausesAtRunTime(const RobotTree& tree, const StoredCalibration& calibration) {
  std::set<std::string> names;
  for (const auto& [correction, size] : FoundCauses(tree, calibration)) {
    if (IsAtRunTime(correction)) names.insert(correction.name);
  }
  return names;
}

}  // namespace elastocal
