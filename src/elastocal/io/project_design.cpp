#include <algorithm>
#include <cmath>

#include "elastocal/io/project_sections.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {
namespace {

Eigen::Vector3d ReadPoint(const YamlValue& value) {
  const std::vector<YamlValue> items = value.Items();
  value.Expect(items.size() == 3, "three numbers, x, y and z");
  return kMetresPerMm * Eigen::Vector3d(items[0].Number(), items[1].Number(), items[2].Number());
}

double ReadShare(const YamlValue& value, double below) {
  const double share = value.Number();
  value.Expect(share >= 0.0 && share <= below, "a number from 0 to " + FormatNumber(below));
  return share;
}

int SphereNamedBy(const YamlValue& value, const std::vector<CollisionSphere>& spheres) {
  std::vector<std::string> names;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    if (spheres[s].name == value.Text()) return static_cast<int>(s);
    names.push_back(spheres[s].name);
  }
  value.Fail("there is no sphere " + Quote(value.Text()) + DidYouMean(value.Text(), names));
}

std::vector<int> ReadSupport(const YamlValue& value, const RobotTree& tree) {
  std::vector<int> links;
  for (const YamlValue& item : value.Items()) links.push_back(LinkNamedBy(item, tree));
  return links;
}

Box ReadBox(const YamlValue& value) {
  value.ExpectKeys({"lower", "upper"});
  const Box box{ReadPoint(value.Get("lower")), ReadPoint(value.Get("upper"))};
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
    setup.support = ReadSupport(*support, project.tree);
  }
  if (const auto box = value.Find("box_mm")) setup.box = ReadBox(*box);
  if (const auto cone = value.Find("cone_deg")) {
    const double degrees = cone->Number();
    cone->Expect(degrees > 0.0 && degrees <= 180.0, "an angle above 0 and of at most 180 degrees");
    setup.largest_turn = kRadiansPerDegree * degrees;
  }
  if (const auto floor = value.Find("floor_mm")) setup.floor_z = kMetresPerMm * floor->Number();
  if (const auto contacts = value.Find("contacts")) {
    setup.contacts = ReadContacts(*contacts, project.motion.spheres);
  }
  return setup;
}

/// The limits with a share of the range left free at either end; half a turn or 0.5 m where there
/// is none.
void SetLimits(const RobotTree& tree, double margin, MotionSetup& motion) {
  motion.lower.resize(tree.coordinate_count());
  motion.upper.resize(tree.coordinate_count());
  for (int i = 0; i < tree.coordinate_count(); ++i) {
    const Joint& joint = tree.joints[tree.coordinate_joint[i]];
    const double unlimited = joint.type == JointType::kRevolute ? M_PI : 0.5;
    const double lower = std::isfinite(joint.limits.lower) ? joint.limits.lower : -unlimited;
    const double upper = std::isfinite(joint.limits.upper) ? joint.limits.upper : unlimited;
    motion.lower[i] = lower + margin * (upper - lower);
    motion.upper[i] = upper - margin * (upper - lower);
  }
}

void ReadRest(const YamlValue& section, const RobotTree& tree, MotionSetup& motion) {
  for (const auto& [name, value] : section.Entries()) {
    const int joint = DriverNamedBy(name, value, tree);
    const int i = tree.joints[joint].coordinate;
    const double unit =
        tree.joints[joint].type == JointType::kRevolute ? kRadiansPerDegree : kMetresPerMm;
    motion.rest[i] = unit * value.Number();
    value.Expect(motion.rest[i] >= motion.lower[i] && motion.rest[i] <= motion.upper[i],
                 "a position within the joint's limits, " + FormatNumber(motion.lower[i] / unit) +
                     " to " + FormatNumber(motion.upper[i] / unit));
  }
}

}  // namespace

void ReadCollision(const YamlValue& section, Project& project) {
  section.ExpectKeys({"margin_mm", "spheres"});
  MotionSetup& motion = project.motion;
  if (const auto margin = section.Find("margin_mm")) {
    margin->Expect(margin->Number() >= 0.0, "a number of at least 0");
    motion.sphere_margin = kMetresPerMm * margin->Number();
  }
  const auto spheres = section.Find("spheres");
  if (!spheres) return;
  for (const YamlValue& value : spheres->Items()) {
    value.ExpectKeys({"name", "link", "centre_mm", "radius_mm"});
    CollisionSphere sphere;
    sphere.name = value.Get("name").Text();
    for (const CollisionSphere& other : motion.spheres) {
      if (other.name == sphere.name) {
        value.Fail("a second sphere of the name " + Quote(sphere.name));
      }
    }
    sphere.link = LinkNamedBy(value.Get("link"), project.tree);
    sphere.p_link_centre = ReadPoint(value.Get("centre_mm"));
    const YamlValue radius = value.Get("radius_mm");
    radius.Expect(radius.Number() > 0.0, "a number above 0");
    sphere.radius = kMetresPerMm * radius.Number();
    motion.spheres.push_back(std::move(sphere));
  }
}

void ReadDesign(const YamlValue& section, Project& project) {
  section.ExpectKeys({"rest_deg", "limit_margin", "effort_share", "chains", "cameras_mm"});
  MotionSetup& motion = project.motion;
  if (const auto margin = section.Find("limit_margin")) {
    SetLimits(project.tree, ReadShare(*margin, 0.4), motion);
    motion.rest = motion.rest.cwiseMax(motion.lower).cwiseMin(motion.upper);
  }
  if (const auto share = section.Find("effort_share")) {
    motion.effort_share = ReadShare(*share, 1.0);
  }
  if (const auto rest = section.Find("rest_deg")) ReadRest(*rest, project.tree, motion);
  if (const auto cameras = section.Find("cameras_mm")) {
    for (const YamlValue& camera : cameras->Items()) motion.cameras.push_back(ReadPoint(camera));
  }
  if (const auto chains = section.Find("chains")) {
    for (const YamlValue& value : chains->Items()) {
      ChainSetup setup = ReadChainSetup(value, project);
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
  constexpr double kLimitMargin = 0.02;
  SetLimits(project.tree, kLimitMargin, project.motion);
  project.motion.rest = Eigen::VectorXd::Zero(project.tree.coordinate_count())
                            .cwiseMax(project.motion.lower)
                            .cwiseMin(project.motion.upper);
}

}  // namespace elastocal
