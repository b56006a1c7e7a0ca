// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observed_robot.hpp"

#include <algorithm>
#include <set>

#include "elastocal/calibration/options.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/recording.hpp"

namespace elastocal {
namespace {

/// Links that joints move and instruments see, ascending.
std::set<int> MovingLinks(const RobotTree& tree, const ObservationSetup& setup) {
  std::set<int> links;
  for (const auto& instrument : setup.instruments) {
    for (int link : instrument->links) {
      if (tree.links[link].body > 0) links.insert(link);
    }
  }
  return links;
}

/// Makes the parameters that match `patterns`, if any, one unknown: that of the first of them.
void JoinUnknowns(const std::vector<std::string>& patterns, const ErrorModel& robot,
                  std::vector<int>& unknown) {
  const std::vector<int> joined = MatchParameters(robot.parameters, patterns);
  if (joined.empty()) return;
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

/// Numbers the unknowns without gaps.
void NumberUnknowns(ObservedRobot& model) {
  std::vector<int> number(model.unknown.size(), -1);
  model.unknown_count = 0;
  for (int& unknown : model.unknown) {
    if (unknown < 0) continue;
    if (number[unknown] < 0) number[unknown] = model.unknown_count++;
    unknown = number[unknown];
  }
}

/// What a joint carries: whether a foot, and how many observed bodies that carry no other one.
struct CarriedLinks {
  bool foot = false;
  int ends = 0;
};

std::vector<CarriedLinks> CountCarried(const ObservedRobot& model) {
  const RobotTree& tree = model.robot.tree;
  std::vector<CarriedLinks> carried(tree.joints.size());
  for (const ContactFoot& foot : model.setup.feet) {
    for (int k : JointsToBody(tree, tree.links[foot.link].body)) carried[k].foot = true;
  }
  std::set<int> bodies;
  for (int link : MovingLinks(tree, model.setup)) bodies.insert(tree.links[link].body);
  for (int body : bodies) {
    const auto carries = [&](int other) {
      const std::vector<int> joints = JointsToBody(tree, other);
      return other != body && std::find(joints.begin(), joints.end(), body - 1) != joints.end();
    };
    if (std::any_of(bodies.begin(), bodies.end(), carries)) continue;
    for (int k : JointsToBody(tree, body)) ++carried[k].ends;
  }
  return carried;
}

}  // namespace

ObservedRobot MakeObservedRobot(const RobotTree& tree, const PlacementOptions& placement,
                                const ObservationSetup& setup, const std::vector<int>& torsion,
                                const std::vector<int>& bending,
                                const std::vector<Correction>& corrections) {
  Elasticity elasticity{.torsion = torsion, .bending = bending, .base = false};
  elasticity.stands_on_legs = !setup.feet.empty();
  elasticity.corrections = corrections;
  for (std::size_t i = 0; i < setup.feet.size(); ++i) {
    elasticity.legs.push_back({"foot_" + std::to_string(i + 1), setup.feet[i].link});
  }
  ObservedRobot model;
  model.setup = setup;
  model.leg_of_link.assign(tree.links.size(), -1);
  for (int link : MovingLinks(tree, setup)) {
    model.leg_of_link[link] = static_cast<int>(elasticity.legs.size());
    elasticity.legs.push_back({"observed_" + std::to_string(link), link});
  }
  if (setup.feet.empty()) {
    const Quantity tilt{"root.tilt", {kRootTilt, kRootTilt}, true};
    const auto is_tilt = [&](const Quantity& of) { return of.sources == tilt.sources; };
    const auto found = std::find_if(setup.quantities.begin(), setup.quantities.end(), is_tilt);
    // The setup comes from another model of the same robot.
    model.root_tilt = found != setup.quantities.end()
                          ? static_cast<int>(found - setup.quantities.begin())
                          : AddQuantity(model.setup, tilt);
  }
  model.robot = MakeErrorModel(tree, {}, placement, elasticity);
  const std::vector<Parameter>& parameters = model.robot.parameters;
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

void KeepObservedUnknowns(const Observations& observations, ObservedRobot& model) {
  const RobotTree& tree = model.robot.tree;
  std::vector<char> seen(tree.joints.size(), 0);
  const auto see = [&](int link) {
    for (int k : JointsToBody(tree, tree.links[link].body)) seen[k] = 1;
  };
  for (const ContactFoot& foot : model.setup.feet) see(foot.link);
  for (const Observation& observation : observations.all) {
    for (int link : model.instrument(observation.instrument).links) see(link);
  }
  for (std::size_t i = 0; i < model.unknown.size(); ++i) {
    const int joint = model.robot.parameters[i].joint;
    if (joint >= 0 && seen[joint] == 0) model.unknown[i] = -1;
  }
  NumberUnknowns(model);
}

std::vector<SourceOfParameter> SourcesOfParameters(const ObservedRobot& model) {
  const std::vector<CarriedLinks> carried = CountCarried(model);
  const Prior prior;
  std::vector<SourceOfParameter> sources;
  for (const Parameter& parameter : model.robot.parameters) {
    SourceOfParameter of;
    if (parameter.kind == ParameterKind::kCorrection) {
      of.source = kCause;
      of.unit = parameter.typical;
    } else if (IsCompliance(parameter.kind)) {
      of.source = parameter.kind == ParameterKind::kTorsion ? kTorsion : kBending;
      of.unit = prior.Of(model.robot.tree, parameter);
    } else if (parameter.kind == ParameterKind::kTheta && parameter.joint >= 0) {
      const CarriedLinks& by = carried[parameter.joint];
      of.source = by.foot ? kLegOffset : by.ends > 1 ? kTrunkOffset : kLimbOffset;
    } else if (IsAngle(parameter.kind)) {
      of.source = kAngle;
    }
    sources.push_back(of);
  }
  return sources;
}

std::vector<int> ParameterOfUnknown(const ObservedRobot& model) {
  std::vector<int> first(static_cast<std::size_t>(model.unknown_count), -1);
  for (int i = 0; i < model.robot.parameter_count(); ++i) {
    const int unknown = model.unknown[i];
    if (unknown >= 0 && first[unknown] < 0) first[unknown] = i;
  }
  return first;
}

void NoteApproach(Observations& observations) {
  std::vector<int> files;
  for (const PosturePlace& place : observations.postures) files.push_back(place.file);
  observations.approach = ApproachesOf(observations.q, files);
}

Observations SelectPostures(const Observations& observations, const std::vector<int>& postures) {
  Observations selected{
      observations.files, observations.effects, {}, observations.q(postures, Eigen::all), {}, {}};
  if (observations.approach.rows() > 0) {
    selected.approach = observations.approach(postures, Eigen::all);
  }
  std::vector<int> now(observations.postures.size(), -1);
  for (int i : postures) {
    now[i] = selected.posture_count();
    selected.postures.push_back(observations.postures[i]);
  }
  for (const Observation& observation : observations.all) {
    if (now[observation.posture] < 0) continue;
    selected.all.push_back(observation);
    selected.all.back().posture = now[observation.posture];
  }
  return selected;
}

Observations WithoutObservations(const Observations& observations, const std::set<int>& out) {
  Observations without = observations;
  without.all.clear();
  std::set<int> showing;
  for (int i = 0; i < observations.count(); ++i) {
    if (out.contains(i)) continue;
    without.all.push_back(observations.all[Size(i)]);
    showing.insert(without.all.back().posture);
  }
  return SelectPostures(without, {showing.begin(), showing.end()});
}

}  // namespace elastocal
