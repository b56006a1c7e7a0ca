// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/error_model.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

using Kind = ParameterKind;

std::vector<int> JointsToLink(const RobotTree& tree, int link) {
  return JointsToBody(tree, tree.links[link].body);
}

std::vector<int> ActiveJoints(const RobotTree& tree, const std::vector<Marker>& markers,
                              const std::vector<SupportLeg>& legs) {
  std::set<int> active;
  for (const Marker& marker : markers) {
    for (int joint : JointsToLink(tree, marker.link)) active.insert(joint);
  }
  for (const SupportLeg& leg : legs) active.insert(leg.joints.begin(), leg.joints.end());
  return {active.begin(), active.end()};
}

void AddBaseParameters(std::vector<Parameter>& parameters) {
  for (const char* name : {"gamma", "b", "alpha", "d", "theta", "r"}) {
    const bool length = name[1] == '\0';
    parameters.push_back({std::string("waist.T0.") + name, Kind::kWaistPose,
                          length ? ParameterUnit::kMetre : ParameterUnit::kRadian});
  }
}

void AddJointParameters(const RobotTree& tree, int joint, const JointPlacement& placement,
                        std::vector<Parameter>& parameters) {
  const auto add = [&](Kind kind, ParameterUnit unit) {
    parameters.push_back({tree.joints[joint].name + "." + KindName(kind), kind, unit, joint});
  };
  if (placement.general) {
    add(Kind::kGamma, ParameterUnit::kRadian);
    add(Kind::kB, ParameterUnit::kMetre);
  }
  if (placement.parallel) add(Kind::kBeta, ParameterUnit::kRadian);
  add(Kind::kAlpha, ParameterUnit::kRadian);
  add(Kind::kD, ParameterUnit::kMetre);
  add(Kind::kTheta, ParameterUnit::kRadian);
  add(Kind::kR, ParameterUnit::kMetre);
}

bool Contains(const std::vector<int>& values, int value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

void AddJointCompliances(const ErrorModel& model, int k, std::vector<Parameter>& parameters) {
  const Joint& joint = model.tree.joints[k];
  const bool slides = joint.type == JointType::kPrismatic;
  const auto add = [&](const char* name, Kind kind, int axis) {
    parameters.push_back(
        {joint.name + name, kind,
         slides ? ParameterUnit::kMetrePerNewton : ParameterUnit::kRadianPerNewtonMetre, k, -1, -1,
         axis});
  };
  if (Contains(model.elasticity.torsion, k)) add(".compliance_z", Kind::kTorsion, 2);
  if (Contains(model.elasticity.bending, k)) {
    add(".compliance_x", Kind::kBending, 0);
    add(".compliance_y", Kind::kBending, 1);
  }
  if (Contains(model.elasticity.root_bending, k)) {
    add(".compliance_root_x", Kind::kBending, kRootAxis);
    add(".compliance_root_y", Kind::kBending, kRootAxis + 1);
    add(".compliance_root_z", Kind::kBending, kRootAxis + 2);
  }
}

/// Whether a correction of loads has an effect: a joint that carries its body (of gravity: any
/// active joint) is elastic, the root link stands still and does not bend.
bool ActsThroughLoads(const ErrorModel& model, const Correction& correction) {
  const Elasticity& elasticity = model.elasticity;
  if (elasticity.stands_on_legs && !model.legs.empty()) return false;
  if (!elasticity.root_bending.empty()) return false;
  const int last = correction.source;
  if (last >= 0 && !Contains(model.active_joints, last)) return false;
  const std::vector<int> joints =
      last < 0 ? model.active_joints : JointsToBody(model.tree, last + 1);
  return std::any_of(joints.begin(), joints.end(), [&](int k) {
    return Contains(elasticity.torsion, k) || Contains(elasticity.bending, k);
  });
}

/// Adds the corrections of a target as parameters; for kJoint, those of joint `joint`.
void AddCorrections(const ErrorModel& model, CorrectionTarget target, int joint,
                    std::vector<Parameter>& parameters) {
  const std::vector<Correction>& corrections = model.elasticity.corrections;
  for (std::size_t i = 0; i < corrections.size(); ++i) {
    if (TargetOf(corrections[i]) != target || corrections[i].joint != joint) continue;
    if (target == CorrectionTarget::kMarker && corrections[i].marker < 0) continue;
    if (target == CorrectionTarget::kLoads && !ActsThroughLoads(model, corrections[i])) continue;
    parameters.push_back({corrections[i].name, Kind::kCorrection, corrections[i].unit, joint,
                          corrections[i].marker, -1, -1, static_cast<int>(i),
                          corrections[i].typical});
  }
}

/// A joint that two legs share has one sensor and hence one bias, which counts for the first leg.
void AddLegParameters(const ErrorModel& model, int leg, std::set<int>& biased,
                      std::vector<Parameter>& parameters) {
  const std::string prefix = model.legs[leg].name + ".compliance_";
  const char* const axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    parameters.push_back(
        {prefix + axes[i], Kind::kLegForce, ParameterUnit::kMetrePerNewton, -1, -1, leg, i});
  }
  for (int i = 0; i < 3; ++i) {
    parameters.push_back({prefix + "r" + axes[i], Kind::kLegMoment,
                          ParameterUnit::kRadianPerNewtonMetre, -1, -1, leg, i});
  }
  if (!model.elasticity.torque_bias) return;
  for (int k : model.legs[leg].joints) {
    if (!biased.insert(k).second) continue;
    const Joint& joint = model.tree.joints[k];
    const bool slides = joint.type == JointType::kPrismatic;
    parameters.push_back({joint.name + ".torque_bias", Kind::kTorqueBias,
                          slides ? ParameterUnit::kNewton : ParameterUnit::kNewtonMetre, k, -1,
                          leg});
  }
}

void AddLinkageParameters(const ErrorModel& model, int index, std::vector<Parameter>& parameters) {
  const Linkage& linkage = model.tree.linkages[index];
  const auto is_active = [&](int k) { return Contains(model.active_joints, k); };
  if (std::none_of(linkage.joints.begin(), linkage.joints.end(), is_active)) return;
  for (const Rod& rod : linkage.rods) {
    for (const auto& [quantity, sd] : rod.uncertain) {
      const bool zero = quantity == RodQuantity::kZero;
      Parameter parameter{rod.motor + "." + RodQuantityName(quantity),
                          zero ? Kind::kMotorZero : Kind::kRod,
                          zero ? ParameterUnit::kRadian : ParameterUnit::kMetre};
      parameter.linkage = index;
      parameter.typical = sd;
      parameters.push_back(std::move(parameter));
    }
  }
}

void AddMarkerParameters(const std::vector<Marker>& markers, std::vector<Parameter>& parameters) {
  for (std::size_t i = 0; i < markers.size(); ++i) {
    for (const char* coordinate : {"x", "y", "z"}) {
      parameters.push_back({"marker." + markers[i].name + "." + coordinate, Kind::kMarker,
                            ParameterUnit::kMetre, -1, static_cast<int>(i)});
    }
  }
}

int IndexOfMarker(const std::vector<Marker>& markers, const std::string& name) {
  const auto at = std::find_if(markers.begin(), markers.end(),
                               [&](const Marker& marker) { return marker.name == name; });
  return at == markers.end() ? -1 : static_cast<int>(at - markers.begin());
}

void CheckMarkers(const RobotTree& tree, const std::vector<Marker>& markers) {
  std::set<std::string> names;
  for (const Marker& marker : markers) {
    if (!names.insert(marker.name).second) {
      throw std::invalid_argument("two markers are called '" + marker.name + "'");
    }
    if (marker.link < 0 || marker.link >= static_cast<int>(tree.links.size())) {
      throw std::invalid_argument("marker '" + marker.name + "' is on a link that does not exist");
    }
  }
}

void CheckElasticity(const RobotTree& tree, const Elasticity& elasticity) {
  for (const auto* joints : {&elasticity.torsion, &elasticity.bending, &elasticity.root_bending}) {
    for (int k : *joints) {
      if (k < 0 || k >= static_cast<int>(tree.joints.size())) {
        throw std::invalid_argument("a joint that does not exist is elastic");
      }
    }
  }
  for (int k : elasticity.bending) {
    if (tree.joints[k].type == JointType::kPrismatic) {
      throw std::invalid_argument("prismatic joint '" + tree.joints[k].name + "' cannot bend");
    }
  }
  for (int k : elasticity.root_bending) {
    if (tree.joints[k].parent_body == 0 && tree.joints[k].type == JointType::kRevolute) continue;
    throw std::invalid_argument("'" + tree.joints[k].name +
                                "' is no revolute joint on the root link");
  }
  std::set<std::string> names;
  for (const Elasticity::Leg& leg : elasticity.legs) {
    if (!names.insert(leg.name).second) {
      throw std::invalid_argument("two legs are called '" + leg.name + "'");
    }
    if (leg.link < 0 || leg.link >= static_cast<int>(tree.links.size()) ||
        tree.links[leg.link].body == 0) {
      throw std::invalid_argument("leg '" + leg.name + "' has no joints");
    }
  }
}

/// Sets the markers of the model, and the parameters of the markers and of the joints that move
/// them.
void SetMarkers(ErrorModel& model, std::vector<Marker> markers) {
  CheckMarkers(model.tree, markers);
  model.active_joints = ActiveJoints(model.tree, markers, model.legs);
  model.parameters.clear();
  AddBaseParameters(model.parameters);
  for (Correction& correction : model.elasticity.corrections) {
    correction.marker = IndexOfMarker(markers, correction.marker_name);
  }
  AddCorrections(model, CorrectionTarget::kRoot, -1, model.parameters);
  AddCorrections(model, CorrectionTarget::kLoads, -1, model.parameters);
  for (int joint : model.active_joints) {
    AddJointParameters(model.tree, joint, model.placements[joint], model.parameters);
    AddJointCompliances(model, joint, model.parameters);
    AddCorrections(model, CorrectionTarget::kJoint, joint, model.parameters);
  }
  std::set<int> biased;
  for (int leg = 0; leg < model.leg_count() && model.elasticity.base; ++leg) {
    AddLegParameters(model, leg, biased, model.parameters);
  }
  for (int i = 0; i < static_cast<int>(model.tree.linkages.size()); ++i) {
    AddLinkageParameters(model, i, model.parameters);
  }
  AddCorrections(model, CorrectionTarget::kMarker, -1, model.parameters);
  AddMarkerParameters(markers, model.parameters);
  model.markers = std::move(markers);
}

}  // namespace

ErrorModel MakeErrorModel(RobotTree tree, std::vector<Marker> markers,
                          const PlacementOptions& options, const Elasticity& elasticity) {
  CheckElasticity(tree, elasticity);
  ErrorModel model;
  model.placements = PlaceJoints(tree, options);
  model.tree = std::move(tree);
  model.elasticity = elasticity;
  for (const Elasticity::Leg& leg : elasticity.legs) {
    model.legs.push_back({leg.name, leg.link, JointsToLink(model.tree, leg.link)});
  }
  SetMarkers(model, std::move(markers));
  return model;
}

ErrorModel SelectMarkers(const ErrorModel& model, const std::vector<std::string>& names) {
  std::vector<Marker> selected;
  std::vector<std::string> known;
  for (const Marker& marker : model.markers) known.push_back(marker.name);
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      throw InputError("no marker '" + name + "'" + DidYouMean(name, known));
    }
    selected.push_back(model.markers[found - known.begin()]);
  }
  ErrorModel result = model;
  SetMarkers(result, std::move(selected));
  return result;
}

std::map<std::string, double> NamedErrors(const ErrorModel& model, const Eigen::VectorXd& errors) {
  std::map<std::string, double> named;
  for (int i = 0; i < model.parameter_count(); ++i) named[model.parameters[i].name] = errors[i];
  return named;
}

Eigen::VectorXd ErrorsByName(const ErrorModel& model, const std::map<std::string, double>& named) {
  Eigen::VectorXd errors = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const auto found = named.find(model.parameters[i].name);
    if (found != named.end()) errors[i] = found->second;
  }
  return errors;
}

}  // namespace elastocal
