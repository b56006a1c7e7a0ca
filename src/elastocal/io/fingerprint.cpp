// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/fingerprint.hpp"

#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/coordinates.hpp"

namespace elastocal {
namespace {

/// Text in which equal numbers look the same: rounded to 1e-9, and 0 where that leaves -0.
class RoundedText {
 public:
  void Add(const std::string& word) { text_ += word + ' '; }
  void Add(double number) { text_ += fmt::format("{:.0f} ", std::round(number * 1e9) + 0.0); }
  /// As cosine and sine: pi and -pi are the same angle, and which of them it is may be rounding.
  void AddAngle(double angle) {
    Add(std::cos(angle));
    Add(std::sin(angle));
  }
  void Add(const Transform& T) {
    for (const double number : T.matrix().topRows<3>().reshaped()) Add(number);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void AddLinkage(const RobotTree& tree, const Linkage& linkage, RoundedText& text) {
  for (const int k : linkage.joints) text.Add(tree.joints[Size(k)].name);
  for (const Rod& rod : linkage.rods) {
    text.Add(rod.motor);
    text.Add(rod.actuator ? "actuator" : "crank");
    text.Add(tree.links[Size(rod.from_link)].name);
    text.Add(tree.links[Size(rod.to_link)].name);
    for (const Eigen::Vector3d& at : {rod.centre, rod.axis, rod.pin, rod.anchor}) {
      for (const double number : at) text.Add(number);
    }
    text.Add(rod.length);
    text.Add(rod.branch);
  }
}

std::uint64_t Fnv1a(std::string_view text) {
  std::uint64_t hash = 14695981039346656037u;
  for (const unsigned char byte : text) hash = (hash ^ byte) * 1099511628211u;
  return hash;
}

}  // namespace

std::string NominalFingerprint(const ErrorModel& model) {
  const RobotTree& tree = model.tree;
  RoundedText text;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    text.Add(joint.name);
    text.Add(joint.type == JointType::kRevolute ? "revolute" : "prismatic");
    text.Add(joint.parent_body == 0 ? "waist" : tree.joints[joint.parent_body - 1].name);
    text.Add(JointOfCoordinate(tree, joint.coordinate).name);
    text.Add(joint.multiplier);
    for (const Drive& drive : joint.more) {
      text.Add(JointOfCoordinate(tree, drive.coordinate).name);
      text.Add(drive.multiplier);
    }
    text.Add(joint.offset);
    const JointPlacement& placement = model.placements[k];
    text.Add(placement.T_parent_pre);
    for (double length : {placement.b, placement.d, placement.r}) text.Add(length);
    for (double angle : {placement.gamma, placement.beta, placement.alpha, placement.theta}) {
      text.AddAngle(angle);
    }
    text.Add(placement.T_joint_body);
  }
  for (const Linkage& linkage : tree.linkages) AddLinkage(tree, linkage, text);
  return CalibrationFingerprint(text.text());
}

std::string CalibrationFingerprint(std::string_view text) {
  return fmt::format("{:016x}", Fnv1a(text));
}

}  // namespace elastocal
