// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/robot/move_motors.hpp"

namespace elastocal {
namespace {

/// "; if its scale is right, look at ..." where other joints follow the one of a gain; else empty.
std::string Followers(const RecordingFault& fault, const RobotTree& tree) {
  const bool joint = fault.coordinate >= 0 && fault.linkage < 0;
  if (fault.kind != FaultKind::kJointGain || !joint || fault.trial >= 0) return "";
  std::string names;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const bool own = tree.coordinate_joint[Size(fault.coordinate)] == static_cast<int>(k);
    if (own || !IsMovedBy(tree.joints[k], fault.coordinate)) continue;
    names += (names.empty() ? "" : ", ") + tree.joints[k].name;
  }
  return names.empty() ? ""
                       : "; if its scale is right, look at the factors by which " + names +
                             " follow it (couplings of the project, mimic of the URDF)";
}

/// "; if WHOSE scale is right, the cameras' is ..." of the gain of a slide; else empty.
std::string OrScaleOfCameras(const RecordingFault& fault, const std::string& whose,
                             const RobotTree& tree, const Recording& recording) {
  const auto& of = tree.coordinate_joint;
  if (fault.kind != FaultKind::kJointGain || fault.coordinate < 0 || fault.linkage >= 0 ||
      tree.joints[Size(of[Size(fault.coordinate)])].type != JointType::kPrismatic) {
    return "";
  }
  const double scale = 1.0 / (1.0 + fault.size);
  const std::string trial = fault.trial < 0 ? "" : recording.trials[Size(fault.trial)].name;
  return fmt::format(
      "; if {} scale is right, the cameras' is {:.4f} times the true one{}, which --accept "
      "scale{}={:.5f} corrects: measure a known length",
      whose, scale, trial.empty() ? "" : " in trial " + trial, trial.empty() ? "" : ":" + trial,
      scale);
}

}  // namespace

std::string FaultAndRemedy(const RecordingFault& fault, const RobotTree& tree,
                           const Recording& recording) {
  const std::string text = DescribeFault(fault, tree, recording);
  const std::optional<std::string> name = NameOfCorrection(fault, tree, recording);
  const std::string followers = Followers(fault, tree);
  if (!name) return text + followers;
  const std::string scale = OrScaleOfCameras(fault, "its", tree, recording);
  return fmt::format("{} (--accept {} corrects it{})", text, *name,
                     scale.empty() ? followers : scale);
}

std::string FaultsAndRemedies(const std::vector<RecordingFault>& faults, const RobotTree& tree,
                              const Recording& recording) {
  std::string text, names, others;
  std::size_t named = 0;
  for (const RecordingFault& one : faults) {
    text += (text.empty() ? "" : "; ") + DescribeFault(one, tree, recording);
    const std::optional<std::string> name = NameOfCorrection(one, tree, recording);
    if (!name) continue;
    names += " " + *name;
    ++named;
    const std::string joint =
        one.coordinate < 0 ? "" : LoggedPositionOf(tree, one.linkage, one.coordinate).name;
    others += OrScaleOfCameras(one, joint + "'s", tree, recording);
  }
  if (named < faults.size()) return text;
  return fmt::format("{} (--accept{} corrects them{})", text, names, others);
}

}  // namespace elastocal
