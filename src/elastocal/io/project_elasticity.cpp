#include <algorithm>
#include <set>

#include "elastocal/io/project_sections.hpp"

namespace elastocal {
namespace {

/// Joints, ascending, whose names match a pattern.
std::vector<int> MatchingJoints(const RobotTree& tree, const std::vector<std::string>& patterns) {
  std::vector<Parameter> names;
  for (const Joint& joint : tree.joints) {
    names.push_back({joint.name, ParameterKind::kTheta, ParameterUnit::kRadian});
  }
  return MatchParameters(names, patterns);
}

std::vector<std::string> ReadPatterns(const YamlValue& list, const Project& project) {
  std::vector<std::string> patterns;
  for (const YamlValue& value : list.Items()) {
    patterns.push_back(value.Text());
    if (MatchingJoints(project.tree, {patterns.back()}).empty()) {
      value.Fail("no joint matches '" + patterns.back() + "'");
    }
  }
  return patterns;
}

}  // namespace

void ReadElasticity(const YamlValue& section, Project& project) {
  ElasticityChoice& choice = project.elasticity;
  section.ExpectKeys({"torsion", "bending", "base", "torque_bias"});
  if (const auto torsion = section.Find("torsion"))
    choice.torsion = ReadPatterns(*torsion, project);
  if (const auto bending = section.Find("bending"))
    choice.bending = ReadPatterns(*bending, project);
  if (const auto base = section.Find("base")) choice.base = base->Boolean();
  if (const auto bias = section.Find("torque_bias")) choice.torque_bias = bias->Boolean();
}

ErrorModel MakeProjectModel(const Project& project, const std::vector<Trial>& trials) {
  std::set<int> standing, on_floor;  // links on which a trial stands alone; joints of any support
  for (const Trial& trial : trials) {
    if (trial.support.size() == 1) standing.insert(trial.support[0]);
    for (int link : trial.support) {
      for (int joint : JointsToBody(project.tree, project.tree.links[link].body)) {
        on_floor.insert(joint);
      }
    }
  }
  Elasticity elasticity;
  elasticity.torque_bias = project.elasticity.torque_bias;
  for (const Chain& chain : project.chains) {
    if (!project.elasticity.base || !standing.contains(chain.tip_link)) continue;
    elasticity.legs.push_back({chain.name, chain.tip_link});
    standing.erase(chain.tip_link);  // a second chain to the same foot is the same leg
  }
  const bool trials_given = !trials.empty();
  const ElasticityChoice& choice = project.elasticity;
  if (choice.torsion || trials_given) {
    elasticity.torsion =
        MatchingJoints(project.tree, choice.torsion.value_or(std::vector<std::string>{"*"}));
  }
  std::vector<int> bending(on_floor.begin(), on_floor.end());
  if (choice.bending) bending = MatchingJoints(project.tree, *choice.bending);
  for (int joint : bending) {
    if (project.tree.joints[joint].type == JointType::kRevolute)
      elasticity.bending.push_back(joint);
  }
  return MakeErrorModel(project.tree, project.markers, project.placement, elasticity);
}

}  // namespace elastocal
