// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <set>
#include <sstream>
#include <tuple>

#include "elastocal/math/numbers.hpp"
#include "elastocal/project/project_sections.hpp"
#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

Eigen::Vector2d ReadCorner(const YamlValue& value) {
  const std::vector<YamlValue> items = value.Items();
  value.Expect(items.size() == 2, "two numbers, x and y");
  return kOneMm * Eigen::Vector2d(items[0].Bounded(), items[1].Bounded());
}

int SphereNamedBy(const YamlValue& value, const std::vector<CollisionSphere>& spheres) {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    if (spheres[s].name == value.Text()) return static_cast<int>(s);
    names.push_back(spheres[s].name);
  }
  value.Fail("there is no sphere " + Quote(value.Text()) + DidYouMean(value.Text(), names));
}

Box ReadBox(const YamlValue& value) {
  value.ExpectKeys({"lower", "upper"});
  const Box box{PointFromMm(value.Get("lower")), PointFromMm(value.Get("upper"))};
  value.Expect((box.lower.array() < box.upper.array()).all(), "a lower corner below the upper one");
  return box;
}

std::vector<SpherePair> ReadContacts(const YamlValue& value,
                                     const std::vector<CollisionSphere>& spheres) {
  std::vector<SpherePair> pairs;
  for (const YamlValue& item : value.Items()) {
    const std::vector<YamlValue> two = item.Items();
    item.Expect(two.size() == 2, "the names of two spheres");
    const SpherePair pair{SphereNamedBy(two[0], spheres), SphereNamedBy(two[1], spheres)};
    if (spheres[pair.first].link == spheres[pair.second].link) {
      item.Fail("the two spheres are on one link and cannot meet");
    }
    pairs.push_back(pair);
  }
  return pairs;
}

ChainSetup ReadChainSetup(const YamlValue& value, const Project& project) {
  value.ExpectKeys({"chain", "mirror", "support", "box_mm", "cone_deg", "floor_mm", "contacts"});
  const Chain& chain = project.chains[ChainNamedBy(value.Get("chain"), project)];
  ChainSetup setup;
  setup.name = chain.name;
  setup.from_link = chain.from_link;
  setup.tip_link = chain.tip_link;
  setup.coordinates = ChainCoordinates(project.tree, chain.from_link, chain.tip_link);
  if (const auto mirror = value.Find("mirror")) {
    setup.mirror = project.chains[ChainNamedBy(*mirror, project)].name;
  }
  if (const auto support = value.Find("support")) {
    setup.support = LinksNamedBy(*support, project.tree);
  }
  if (const auto box = value.Find("box_mm")) setup.box = ReadBox(*box);
  if (const auto cone = value.Find("cone_deg")) {
    setup.largest_turn = kOneDegree * cone->Bounded();
  }
  if (const auto floor = value.Find("floor_mm")) setup.floor_z = kOneMm * floor->Bounded();
  if (const auto contacts = value.Find("contacts")) {
    setup.contacts = ReadContacts(*contacts, project.motion.spheres);
  }
  return setup;
}

/// Usual ChainSetup::dexterity_share of a lifted leg: with less, its joints can hardly put the foot
/// where it belongs (Dexterity).
constexpr double kDexterityShare = 0.5;

/// Sets the limits of all joints (PostureRange), with a share of the range left free at either end,
/// and no room for corrections.
void SetLimits(const RobotTree& tree, double margin, MotionSetup& motion) {
  motion.lower.resize(tree.coordinate_count());
  motion.upper.resize(tree.coordinate_count());
  motion.room.setZero(tree.coordinate_count());
  for (int i = 0; i < tree.coordinate_count(); ++i) {
    std::tie(motion.lower[i], motion.upper[i]) =
        PostureRange(tree.joints[tree.coordinate_joint[i]], margin);
  }
}

/// Centres the limits of joints that count turns at their positions of rest.
void CentreTurns(const YamlValue& section, const RobotTree& tree, double margin,
                 MotionSetup& motion) {
  for (const auto& [name, value] : section.Entries()) {
    const Joint& joint = tree.joints[DriverNamedBy(name, value, tree)];
    if (joint.type != JointType::kRevolute) continue;
    std::tie(motion.lower[joint.coordinate], motion.upper[joint.coordinate]) =
        PostureRange(joint, margin, kOneDegree * value.Bounded());
  }
}

void ReadRest(const YamlValue& section, const RobotTree& tree, MotionSetup& motion) {
  for (const auto& [name, value] : section.Entries()) {
    const int joint = DriverNamedBy(name, value, tree);
    const int i = tree.joints[joint].coordinate;
    const double unit = tree.joints[joint].type == JointType::kRevolute ? kOneDegree : kOneMm;
    motion.rest[i] = unit * value.Bounded();
    value.Expect(motion.rest[i] >= motion.lower[i] && motion.rest[i] <= motion.upper[i],
                 "a position within the joint's limits, " + FormatNumber(motion.lower[i] / unit) +
                     " to " + FormatNumber(motion.upper[i] / unit));
  }
}

/// Reads ranges of joints that are narrower than their limits; for a joint that counts turns, the
/// range also chooses the turn.
void ReadRanges(const YamlValue& section, const RobotTree& tree, double margin,
                MotionSetup& motion) {
  for (const auto& [name, value] : section.Entries()) {
    const int joint = DriverNamedBy(name, value, tree);
    const int i = tree.joints[joint].coordinate;
    const double unit = tree.joints[joint].type == JointType::kRevolute ? kOneDegree : kOneMm;
    const std::vector<YamlValue> ends = value.Items();
    value.Expect(ends.size() == 2, "two numbers, the lower and the upper end");
    const double lower = unit * ends[0].Bounded(), upper = unit * ends[1].Bounded();
    std::tie(motion.lower[i], motion.upper[i]) =
        PostureRange(tree.joints[joint], margin, 0.5 * (lower + upper));
    value.Expect(lower < upper && lower < motion.upper[i] && upper > motion.lower[i],
                 "a range of which a part is within the joint's limits, " +
                     FormatNumber(motion.lower[i] / unit) + " to " +
                     FormatNumber(motion.upper[i] / unit));
    motion.lower[i] = std::max(motion.lower[i], lower);
    motion.upper[i] = std::min(motion.upper[i], upper);
  }
  motion.rest = motion.rest.cwiseMax(motion.lower).cwiseMin(motion.upper);
}

Sole ReadSole(const YamlValue& value, const RobotTree& tree) {
  value.ExpectKeys({"link", "lower_mm", "upper_mm", "ball_radius_mm"});
  Sole sole;
  sole.link = LinkNamedBy(value.Get("link"), tree);
  if (const auto radius = value.Find("ball_radius_mm")) {
    value.Expect(!value.Find("lower_mm") && !value.Find("upper_mm"),
                 "either corners of a flat sole or the radius of a ball");
    sole.ball_radius = kOneMm * radius->Bounded();
    return sole;
  }
  sole.lower = ReadCorner(value.Get("lower_mm"));
  sole.upper = ReadCorner(value.Get("upper_mm"));
  value.Expect((sole.lower.array() < sole.upper.array()).all(),
               "a lower corner below the upper one");
  return sole;
}

}  // namespace

void ReadStanding(const YamlValue& section, Project& project) {
  section.ExpectKeys({"soles", "stance_mm"});
  const YamlValue list = section.Get("soles");
  std::set<int> links;
  for (const YamlValue& value : list.Items()) {
    const Sole sole = ReadSole(value, project.tree);
    value.Expect(links.insert(sole.link).second, "a link that is no sole yet");
    project.soles.push_back(sole);
  }
  list.Expect(!project.soles.empty(), "one or more soles");
  const bool balls = std::any_of(project.soles.begin(), project.soles.end(),
                                 [](const Sole& sole) { return sole.ball_radius.has_value(); });
  list.Expect(!balls || project.soles.size() >= 4,
              "four or more soles where there are balls: three stand while one is in the air");
  if (const auto stance = section.Find("stance_mm")) {
    stance->Expect(project.soles.size() == 2, "two soles, which have a distance");
    project.stance = kOneMm * stance->Bounded();
  }
}

void ReadCollision(const YamlValue& section, Project& project) {
  section.ExpectKeys({"margin_mm", "spheres"});
  MotionSetup& motion = project.motion;
  section.ReadBounded("margin_mm", motion.sphere_margin, kOneMm);
  const auto spheres = section.Find("spheres");
  if (!spheres) return;
  for (const YamlValue& value : spheres->Items()) {
    value.ExpectKeys({"name", "link", "centre_mm", "radius_mm"});
    CollisionSphere sphere;
    sphere.name = NewName(value.Get("name"), "sphere", motion.spheres);
    sphere.link = LinkNamedBy(value.Get("link"), project.tree);
    sphere.p_link_centre = PointFromMm(value.Get("centre_mm"));
    sphere.radius = kOneMm * value.Get("radius_mm").Bounded();
    motion.spheres.push_back(std::move(sphere));
  }
}

void CarryRest(Project& project) {
  constexpr double kMostAtRest = 0.8;  // share of an effort; planned motions may use 0.9
  const Eigen::VectorXd torques = GravityTorques(project.tree, project.motion.rest);
  for (int c = 0; c < project.tree.coordinate_count(); ++c) {
    Joint& joint = project.tree.joints[Size(project.tree.coordinate_joint[Size(c)])];
    const double torque = std::abs(torques[c]), effort = joint.limits.effort;
    if (!std::isfinite(effort) || torque <= kMostAtRest * effort) continue;
    joint.limits.effort = torque / kMostAtRest;
    std::ostringstream text;
    text << "joint " << Quote(joint.name) << ": gravity takes " << std::setprecision(3) << torque
         << " of its effort of " << effort << (joint.type == JointType::kPrismatic ? " N" : " N.m")
         << " in the posture of rest; " << joint.limits.effort
         << " are taken instead. Is there a counterweight that the URDF does not have, or is the "
            "effort that of a motor before its gear?";
    project.tree.warnings.push_back(text.str());
  }
}

void ReadDesign(const YamlValue& section, Project& project) {
  section.ExpectKeys({"rest_deg", "limit_margin", "range_deg", "room_deg", "effort_share",
                      "motion_effort_share", "dexterity_share", "chains", "cameras_mm"});
  MotionSetup& motion = project.motion;
  double limit_margin = kUsualLimitMargin;
  section.ReadBounded("limit_margin", limit_margin);
  SetLimits(project.tree, limit_margin, motion);
  motion.rest = motion.rest.cwiseMax(motion.lower).cwiseMin(motion.upper);
  const auto rest = section.Find("rest_deg");
  if (rest) CentreTurns(*rest, project.tree, limit_margin, motion);
  if (const auto ranges = section.Find("range_deg"))
    ReadRanges(*ranges, project.tree, limit_margin, motion);
  if (const auto room = section.Find("room_deg")) {
    for (const auto& [name, value] : room->Entries()) {
      const Joint& joint = project.tree.joints[DriverNamedBy(name, value, project.tree)];
      motion.room[joint.coordinate] = kOneDegree * value.Bounded();
    }
  }
  section.ReadBounded("effort_share", motion.effort_share);
  section.ReadBounded("motion_effort_share", motion.motion_effort_share);
  if (rest) ReadRest(*rest, project.tree, motion);
  if (const auto cameras = section.Find("cameras_mm")) {
    for (const YamlValue& camera : cameras->Items()) motion.cameras.push_back(PointFromMm(camera));
  }
  double dexterity_share = kDexterityShare;
  section.ReadBounded("dexterity_share", dexterity_share);
  if (const auto chains = section.Find("chains")) {
    for (const YamlValue& value : chains->Items()) {
      ChainSetup setup = ReadChainSetup(value, project);
      const bool is_leg = std::any_of(project.soles.begin(), project.soles.end(),
                                      [&](const Sole& s) { return s.link == setup.tip_link; });
      if (is_leg) setup.dexterity_share = dexterity_share;
      for (const ChainSetup& other : motion.chains) {
        if (other.name == setup.name || other.mirror == setup.name) {
          value.Fail("the chain " + Quote(setup.name) + " comes twice");
        }
      }
      motion.chains.push_back(std::move(setup));
    }
  }
}

void SetMotionDefaults(Project& project) {
  SetLimits(project.tree, kUsualLimitMargin, project.motion);
  project.motion.rest = Eigen::VectorXd::Zero(project.tree.coordinate_count())
                            .cwiseMax(project.motion.lower)
                            .cwiseMin(project.motion.upper);
}

}  // namespace elastocal
