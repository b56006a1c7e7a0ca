// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/limb_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

bool IsUpper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool IsSmall(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }

int SideByName(const std::string& name) {
  constexpr std::array kLeft = {"left", "l", "lf", "fl", "lh", "hl", "rl"};
  constexpr std::array kRight = {"right", "r", "rf", "fr", "rh", "hr", "rr"};
  const std::vector<std::string> words = WordsOf(name);
  const auto says = [&](const auto& sides) {
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
      return std::find(sides.begin(), sides.end(), word) != sides.end();
    });
  };
  return static_cast<int>(says(kLeft)) - static_cast<int>(says(kRight));
}

/// Whether the name of the tip, or of one of the limb's own joints, contains one of these words.
bool Says(const RobotTree& tree, const Limb& limb, std::initializer_list<const char*> sought) {
  const auto says = [&](const std::string& name) {
    const std::vector<std::string> words = WordsOf(name);
    return std::find_first_of(words.begin(), words.end(), sought.begin(), sought.end()) !=
           words.end();
  };
  const auto trunk = static_cast<std::ptrdiff_t>(JointsToBody(tree, limb.from_body).size());
  return says(tree.links[Size(limb.tip_link)].name) ||
         std::any_of(limb.joints.begin() + trunk, limb.joints.end(),
                     [&](int k) { return says(tree.joints[Size(k)].name); });
}

}  // namespace

std::vector<std::string> WordsOf(const std::string& name) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) {
      words.emplace_back();
      continue;
    }
    const bool begins =
        i == 0 || IsSmall(name[i - 1]) || (i + 1 < name.size() && IsSmall(name[i + 1]));
    if (IsUpper(c) && begins) words.emplace_back();
    words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return words;
}

int SideByNames(const RobotTree& tree, const Limb& limb) {
  const auto trunk = static_cast<std::ptrdiff_t>(JointsToBody(tree, limb.from_body).size());
  int votes = SideByName(tree.links[Size(limb.tip_link)].name);
  std::for_each(limb.joints.begin() + trunk, limb.joints.end(),
                [&](int k) { votes += SideByName(tree.joints[Size(k)].name); });
  return votes > 0 ? 1 : votes < 0 ? -1 : 0;
}

bool NamedSole(const std::string& name) {
  const std::vector<std::string> words = WordsOf(name);
  return std::find(words.begin(), words.end(), "sole") != words.end();
}

bool IsLegByNames(const RobotTree& tree, const Limb& limb) {
  return Says(tree, limb,
              {"leg", "hip", "thigh", "femur", "knee", "calf", "shank", "shin", "tibia", "ankle",
               "tarsus", "foot", "paw", "hoof", "heel", "toe", "sole"});
}

bool IsArmByNames(const RobotTree& tree, const Limb& limb) {
  return Says(tree, limb, {"arm", "elbow", "forearm", "wrist", "hand", "palm", "gripper"}) &&
         !IsLegByNames(tree, limb);
}

bool IsHeadByNames(const RobotTree& tree, const Limb& limb) {
  return Says(tree, limb, {"head", "neck"});
}

std::string NameLimb(const RobotTree& tree, const std::vector<Limb>& limbs, const Limb& limb) {
  if (limbs.size() == 1) return "arm";
  const Eigen::Vector3d tip =
      LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()))[Size(limb.tip_link)]
          .translation();
  const auto legs = std::count_if(limbs.begin(), limbs.end(), [](const Limb& l) { return l.leg; });
  int side = SideByNames(tree, limb);
  if (limb.mirror < 0) {
    constexpr std::size_t kJointsOfAnArm = 4;
    const std::size_t trunk = JointsToBody(tree, limb.from_body).size();
    if (IsHeadByNames(tree, limb)) return "head";
    if (limb.joints.size() - trunk < kJointsOfAnArm) {
      return Says(tree, limb, {"hip", "knee", "ankle"}) ? "leg" : "head";
    }
    return side > 0 ? "left_arm" : side < 0 ? "right_arm" : "arm";
  }
  const bool named = side * SideByNames(tree, limbs[Size(limb.mirror)]) < 0;
  // Which leg is ahead follows from positions, not from names.
  const bool one_of_four = limb.leg && legs > 2;
  if (!named || one_of_four) side = tip.y() > 0.0 ? 1 : -1;
  std::string name = side > 0 ? "left_" : "right_";
  if (one_of_four) name = (tip.x() > 0.0 ? "front_" : "hind_") + name;
  return name + (limb.leg ? "leg" : "arm");
}

}  // namespace elastocal
