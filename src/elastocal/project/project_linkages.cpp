// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "elastocal/math/numbers.hpp"
#include "elastocal/project/project_sections.hpp"

namespace elastocal {
namespace {

constexpr double kUsualLength = 1e-3;            // m
constexpr double kUsualZero = 0.5 * kOneDegree;  // rad
constexpr std::size_t kMostLinkageJoints = 6;    // of one linkage
constexpr std::size_t kMostLinkages = 100;
constexpr double kLeastUncertain_mm = 1e-6;  // of what is not exact; as the bounds have it

using Coordinates = std::array<RodQuantity, 3>;
constexpr Coordinates kAnchor = {RodQuantity::kAnchorX, RodQuantity::kAnchorY,
                                 RodQuantity::kAnchorZ};
constexpr Coordinates kCentre = {RodQuantity::kCentreX, RodQuantity::kCentreY,
                                 RodQuantity::kCentreZ};

/// A unit vector from three numbers, of any length.
Eigen::Vector3d DirectionOf(const YamlValue& value) {
  const Eigen::Vector3d numbers = NumbersOf(value, 3);
  value.Expect(numbers.norm() > 0.0, "a direction other than [0, 0, 0]");
  return numbers.normalized();
}

std::string NewMotor(const YamlValue& value, const Linkage& linkage, const RobotTree& tree) {
  const std::string name = value.Text();
  const auto is_joint = [&](const Joint& joint) { return joint.name == name; };
  if (std::any_of(tree.joints.begin(), tree.joints.end(), is_joint)) {
    value.Fail("there is a joint of the name " + Quote(name) + "; a name of its own was expected");
  }
  const auto has = [&](const Linkage& other) {
    return std::any_of(other.rods.begin(), other.rods.end(),
                       [&](const Rod& rod) { return rod.motor == name; });
  };
  if (has(linkage) || std::any_of(tree.linkages.begin(), tree.linkages.end(), has)) {
    value.Fail("a second motor of the name " + Quote(name));
  }
  return name;
}

/// Uncertain quantities of a rod if the project does not name them. They also compensate for
/// displaced axes.
std::vector<RodUncertainty> UsuallyUncertain(const Rod& rod) {
  std::vector<RodUncertainty> usual = {{RodQuantity::kLength, kUsualLength}};
  if (!rod.actuator) usual.push_back({RodQuantity::kZero, kUsualZero});
  for (const RodQuantity anchor : kAnchor) usual.push_back({anchor, kUsualLength});
  return usual;
}

std::vector<RodUncertainty> ReadUncertain(const YamlValue& section, const Rod& rod) {
  std::vector<std::string> known = {"length_mm", "anchor_mm", "centre_mm"};
  if (!rod.actuator) known.insert(known.end(), {"zero_deg", "radius_mm"});
  section.ExpectKeys(known);
  std::vector<RodUncertainty> uncertain;
  const auto add = [&](const char* key, double unit, RodQuantity quantity) {
    if (const auto sd = section.Find(key)) uncertain.push_back({quantity, unit * sd->Bounded()});
  };
  const auto add_point = [&](const char* key, const Coordinates& coordinates) {
    const auto value = section.Find(key);
    if (!value) return;
    const Eigen::Vector3d sd = value->IsScalar() ? Eigen::Vector3d::Constant(value->Bounded())
                                                 : Eigen::Vector3d(NumbersOf(*value, 3));
    value->Expect((sd.array() == 0.0 || sd.array() >= kLeastUncertain_mm).all(),
                  "0 where it is exact, or at least 1e-6 mm");
    for (int i = 0; i < 3; ++i) {
      if (sd[i] > 0.0) uncertain.push_back({coordinates[Size(i)], kOneMm * sd[i]});
    }
  };
  add("length_mm", kOneMm, RodQuantity::kLength);
  add("zero_deg", kOneDegree, RodQuantity::kZero);
  add("radius_mm", kOneMm, RodQuantity::kRadius);
  add_point("anchor_mm", kAnchor);
  add_point("centre_mm", kCentre);
  return uncertain;
}

Rod ReadRod(const YamlValue& value, const Linkage& linkage, const RobotTree& tree) {
  Rod rod;
  value.Read("actuator", rod.actuator);
  std::vector<std::string> known = {"motor",     "actuator",  "from",      "to",
                                    "centre_mm", "anchor_mm", "length_mm", "uncertain"};
  if (!rod.actuator) known.insert(known.end(), {"axis", "pin_mm"});
  value.ExpectKeys(known);
  rod.motor = NewMotor(value.Get("motor"), linkage, tree);
  rod.from_link = LinkNamedBy(value.Get("from"), tree);
  rod.to_link = LinkNamedBy(value.Get("to"), tree);
  rod.centre = PointFromMm(value.Get("centre_mm"));
  rod.anchor = PointFromMm(value.Get("anchor_mm"));
  if (!rod.actuator) {
    rod.axis = DirectionOf(value.Get("axis"));
    rod.pin = PointFromMm(value.Get("pin_mm"));
  }
  if (const auto length = value.Find("length_mm")) rod.length = kOneMm * length->Bounded();
  const auto uncertain = value.Find("uncertain");
  rod.uncertain = uncertain ? ReadUncertain(*uncertain, rod) : UsuallyUncertain(rod);
  return rod;
}

Linkage ReadLinkage(const YamlValue& value, const RobotTree& tree) {
  value.ExpectKeys({"name", "joints", "assembled_deg", "rods"});
  Linkage linkage;
  linkage.name = NewName(value.Get("name"), "linkage", tree.linkages);
  const YamlValue joints = value.Get("joints");
  for (const YamlValue& joint : joints.Items()) {
    linkage.joints.push_back(JointNamedBy(joint, tree));
  }
  joints.Expect(linkage.joints.size() <= kMostLinkageJoints, "at most six joints");
  linkage.assembled.setZero(static_cast<Eigen::Index>(linkage.joints.size()));
  if (const auto assembled = value.Find("assembled_deg")) {
    linkage.assembled = kOneDegree * NumbersOf(*assembled, linkage.joints.size());
  }
  for (const YamlValue& rod : value.Get("rods").Items()) {
    linkage.rods.push_back(ReadRod(rod, linkage, tree));
  }
  return linkage;
}

/// Positions of the linkage's joints on a grid within their limits: five values for each of up to
/// two joints, the two limits for each of more.
std::vector<Eigen::VectorXd> GridWithinLimits(const RobotTree& tree, const Linkage& linkage) {
  const int steps = linkage.joints.size() <= 2 ? 4 : 1;
  std::vector<Eigen::VectorXd> grid = {linkage.assembled};
  for (std::size_t j = 0; j < linkage.joints.size(); ++j) {
    const JointLimits& limits = tree.joints[static_cast<std::size_t>(linkage.joints[j])].limits;
    if (!std::isfinite(limits.lower) || !std::isfinite(limits.upper)) continue;
    std::vector<Eigen::VectorXd> finer;
    for (const Eigen::VectorXd& positions : grid) {
      for (int i = 0; i <= steps; ++i) {
        finer.push_back(positions);
        finer.back()[static_cast<Eigen::Index>(j)] =
            limits.lower + (limits.upper - limits.lower) * i / steps;
      }
    }
    grid = std::move(finer);
  }
  return grid;
}

/// Warns of positions that the joints' limits allow and the rods do not.
void WarnOfReach(const Linkage& linkage, RobotTree& tree) {
  for (const Eigen::VectorXd& positions : GridWithinLimits(tree, linkage)) {
    const auto motors = MotorPositions(tree, linkage, positions);
    if (motors && JointsFromMotors(tree, linkage, *motors)) continue;
    std::string where;
    for (std::size_t j = 0; j < linkage.joints.size(); ++j) {
      where += (j == 0 ? "" : ", ") +
               tree.joints[static_cast<std::size_t>(linkage.joints[j])].name + " at " +
               FormatNumber(std::round(positions[static_cast<Eigen::Index>(j)] / kOneDegree)) +
               " deg";
    }
    tree.warnings.push_back("linkage " + linkage.name +
                            ": its rods do not reach all that the limits of its joints allow, as " +
                            where);
    return;
  }
}

}  // namespace

void CheckHasNoLinkages(const Project& project, const std::string& what) {
  if (project.tree.linkages.empty()) return;
  throw InputError(project.file.string() + ": linkages: " + what +
                   " does not know joints that are moved by rods; a robot without linkages was "
                   "expected");
}

void ReadLinkages(const YamlValue& section, Project& project) {
  const std::vector<YamlValue> items = section.Items();
  section.Expect(items.size() <= kMostLinkages, "at most 100 linkages");
  for (const YamlValue& value : items) {
    const Linkage linkage = ReadLinkage(value, project.tree);
    FindNamedBy(value, [&] {
      AddLinkage(linkage, project.tree);
      return 0;
    });
    WarnOfReach(project.tree.linkages.back(), project.tree);
  }
}

}  // namespace elastocal
