// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"

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

}  // namespace

std::string FaultAndRemedy(const RecordingFault& fault, const RobotTree& tree,
                           const Recording& recording) {
  const std::string text = DescribeFault(fault, tree, recording);
  const std::optional<std::string> name = NameOfCorrection(fault, tree, recording);
  const auto& of = tree.coordinate_joint;
  const bool slides = fault.kind == FaultKind::kJointGain && fault.coordinate >= 0 &&
                      tree.joints[Size(of[Size(fault.coordinate)])].type == JointType::kPrismatic;
  if (name && slides && fault.trial < 0) {
    const double scale = 1.0 / (1.0 + fault.size);
    return fmt::format(
        "{} (--accept {} corrects it; if its scale is right, the cameras' is {:.4f} times the true "
        "one, which --accept scale={:.5f} corrects: measure a known length)",
        text, *name, scale, scale);
  }
  const std::string followers = Followers(fault, tree);
  return name ? fmt::format("{} (--accept {} corrects it{})", text, *name, followers)
              : text + followers;
}

}  // namespace elastocal
