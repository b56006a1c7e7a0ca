#include "elastocal/contact/contact_model.hpp"

#include <algorithm>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

ErrorModel RobotOfContacts(const RobotTree& tree, const PlacementOptions& placement,
                           const ContactSetup& setup, const std::vector<int>& torsion,
                           const std::vector<int>& bending) {
  Elasticity elasticity{.torsion = torsion, .bending = bending, .base = false};
  for (std::size_t i = 0; i < setup.feet.size(); ++i) {
    elasticity.legs.push_back({"foot_" + std::to_string(i + 1), setup.feet[i].link});
  }
  for (const ContactPlate& plate : setup.plates) {
    elasticity.legs.push_back({"plate_" + plate.name, plate.link});
  }
  return MakeErrorModel(tree, {}, placement, elasticity);
}

/// Makes the parameters that `patterns` match one unknown: that of the first of them.
void JoinUnknowns(const std::vector<std::string>& patterns, const ErrorModel& robot,
                  std::vector<int>& unknown) {
  CheckPatterns(robot.parameters, patterns);
  const std::vector<int> joined = MatchParameters(robot.parameters, patterns);
  const Parameter& first = robot.parameters[joined.front()];
  for (int i : joined) {
    const Parameter& parameter = robot.parameters[i];
    if (parameter.kind != first.kind || parameter.axis != first.axis) {
      throw InputError("parameters " + first.name + " and " + parameter.name +
                       " are of different kinds and cannot have one value in common");
    }
    unknown[i] = unknown[joined.front()];
  }
}

/// Gives the unknowns numbers without gaps.
void NumberUnknowns(ContactModel& model) {
  std::vector<int> number(model.unknown.size(), -1);
  model.unknown_count = 0;
  for (int& unknown : model.unknown) {
    if (unknown < 0) continue;
    if (number[unknown] < 0) number[unknown] = model.unknown_count++;
    unknown = number[unknown];
  }
}

}  // namespace

ContactModel MakeContactModel(const RobotTree& tree, const PlacementOptions& placement,
                              const ContactSetup& setup, const std::vector<int>& torsion,
                              const std::vector<int>& bending) {
  ContactModel model{RobotOfContacts(tree, placement, setup, torsion, bending), setup, {}, 0};
  const std::vector<Parameter>& parameters = model.robot.parameters;
  CheckPatterns(parameters, setup.hold);
  const std::vector<int> held = MatchParameters(parameters, setup.hold);
  model.unknown.assign(parameters.size(), -1);
  for (int i = 0; i < static_cast<int>(parameters.size()); ++i) {
    if (!IsExternal(parameters[i].kind)) model.unknown[i] = i;
  }
  for (const std::vector<std::string>& patterns : setup.common) {
    JoinUnknowns(patterns, model.robot, model.unknown);
  }
  for (int i : held) model.unknown[i] = -1;
  NumberUnknowns(model);
  return model;
}

void KeepTouchedUnknowns(const Touches& touches, ContactModel& model) {
  const RobotTree& tree = model.robot.tree;
  std::vector<char> seen(tree.joints.size(), 0);
  const auto see = [&](int link) {
    for (int k : JointsToBody(tree, tree.links[link].body)) seen[k] = 1;
  };
  for (const ContactFoot& foot : model.setup.feet) see(foot.link);
  for (const Touch& touch : touches.touches) see(model.setup.plates[touch.plate].link);
  for (std::size_t i = 0; i < model.unknown.size(); ++i) {
    const int joint = model.robot.parameters[i].joint;
    if (joint >= 0 && seen[joint] == 0) model.unknown[i] = -1;
  }
  NumberUnknowns(model);
}

Touches SelectTouches(const Touches& touches, const std::vector<int>& which) {
  Touches selected{touches.files, touches.sessions, {}, touches.q(which, Eigen::all)};
  for (int i : which) selected.touches.push_back(touches.touches[i]);
  return selected;
}

}  // namespace elastocal
