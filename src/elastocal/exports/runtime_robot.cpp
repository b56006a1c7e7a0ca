// SPDX-License-Identifier: Apache-2.0
#include "elastocal/exports/runtime_robot.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "elastocal/exports/runtime_causes.hpp"
#include "elastocal/io/fingerprint.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {
namespace {

ec_pose ToPose(const Transform& T) {
  ec_pose pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.R[3 * row + column] = T.linear()(row, column);
    pose.p[row] = T.translation()[row];
  }
  return pose;
}

/// A joint of the URDF: its twisted frame has z along the axis, and no errors.
ec_joint UrdfJoint(const RobotTree& tree, const Joint& joint) {
  Transform R_child_twisted = Transform::Identity();
  R_child_twisted.linear() = RotationBetween(Eigen::Vector3d::UnitZ(), joint.axis);
  ec_joint result{};
  result.twisted = ToPose(tree.links[static_cast<std::size_t>(joint.parent_link)].T_body_link *
                          joint.T_parent_child * R_child_twisted);
  result.body = ToPose(R_child_twisted.inverse());
  return result;
}

/// A joint with the errors of the model (eq. 1).
ec_joint CalibratedJoint(const ErrorModel& model, const Geometry& geometry, int k, bool elastic) {
  const auto index = static_cast<std::size_t>(k);
  const Geometry::JointConstants& constants = geometry.joints[index];
  const int parent = model.tree.joints[index].parent_body;
  Transform T_parent_twisted = Transform::Identity();
  T_parent_twisted.linear() = constants.R_parent_twisted;
  T_parent_twisted.translation() = constants.p_parent_twisted;
  if (parent > 0) {
    const Transform& T_joint_body =
        model.placements[static_cast<std::size_t>(parent - 1)].T_joint_body;
    T_parent_twisted = T_joint_body.inverse() * T_parent_twisted;
  }
  ec_joint result{};
  result.twisted = ToPose(T_parent_twisted);
  result.theta = constants.theta;
  result.r = constants.r;
  result.centre = constants.centre;
  for (int axis = 0; axis < 3; ++axis) {
    result.compliance[axis] = elastic ? constants.compliance[axis] : 0.0;
    result.root_compliance[axis] = elastic ? constants.root_compliance[axis] : 0.0;
  }
  result.body = ToPose(model.placements[index].T_joint_body);
  return result;
}

void SetMotion(const Joint& joint, ec_joint& result) {
  result.parent = joint.parent_body;
  result.coordinate = joint.coordinate;
  result.prismatic = joint.type == JointType::kPrismatic ? 1 : 0;
  result.multiplier = joint.multiplier;
  result.offset = joint.offset;
}

/// Cuts each coordinate's range to what its mimic joints allow; passes over one that leaves none.
void CutToFollowers(const RobotTree& tree, RuntimeModel& model) {
  for (const Joint& joint : tree.joints) {
    const JointLimits& own = joint.limits;
    if (!joint.mimic || joint.multiplier == 0.0 || !(own.lower < own.upper)) continue;
    const double a = (own.lower - joint.offset) / joint.multiplier;
    const double b = (own.upper - joint.offset) / joint.multiplier;
    double& lower = model.lower[Size(joint.coordinate)];
    double& upper = model.upper[Size(joint.coordinate)];
    const double low = std::max(lower, std::min(a, b)), high = std::min(upper, std::max(a, b));
    if (low < high) std::tie(lower, upper) = std::tuple(low, high);
  }
}

void AddJoints(const StoredRobot& robot, RuntimeContent content, RuntimeModel& model) {
  const RobotTree& tree = robot.model.tree;
  const Geometry geometry = ApplyErrors(robot.model, robot.errors);
  const std::vector<int>& active = robot.model.active_joints;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    if (!joint.more.empty()) {
      throw InputError("joint '" + joint.name +
                       "' is coupled to several others, which the robot at "
                       "run time does not know yet");
    }
    ec_joint nominal = UrdfJoint(tree, joint);
    const bool has_errors = content != RuntimeContent::kNominal &&
                            std::binary_search(active.begin(), active.end(), static_cast<int>(k));
    ec_joint calibrated = has_errors ? CalibratedJoint(robot.model, geometry, static_cast<int>(k),
                                                       content == RuntimeContent::kEverything)
                                     : nominal;
    SetMotion(joint, nominal);
    SetMotion(joint, calibrated);
    model.joint_names.push_back(joint.name);
    model.nominal.push_back(nominal);
    model.calibrated.push_back(calibrated);
  }
  for (int k : tree.coordinate_joint) {
    const Joint& joint = tree.joints[static_cast<std::size_t>(k)];
    model.coordinate_names.push_back(joint.name);
    model.lower.push_back(joint.limits.lower);
    model.upper.push_back(joint.limits.upper);
  }
  CutToFollowers(tree, model);
}

void AddLinks(const RobotTree& tree, RuntimeModel& model) {
  const auto bodies = static_cast<std::size_t>(tree.body_count());
  model.mass.assign(bodies, 0.0);
  model.moment.assign(3 * bodies, 0.0);
  for (const Link& link : tree.links) {
    const auto body = static_cast<std::size_t>(link.body);
    const Eigen::Vector3d moment = link.mass * (link.T_body_link * link.com);
    model.mass[body] += link.mass;
    for (int i = 0; i < 3; ++i) model.moment[3 * body + static_cast<std::size_t>(i)] += moment[i];
    model.link_names.push_back(link.name);
    model.links.push_back({link.body, ToPose(link.T_body_link)});
  }
}

std::vector<NamedChain> ChainNames(const Project& project) {
  std::vector<NamedChain> chains;
  for (const Chain& chain : project.chains) {
    chains.push_back({chain.name, chain.from_link, chain.tip_link});
  }
  return chains;
}

/// Sets the direction of gravity for a root link that was held while it was calibrated.
void SetGravity(const ErrorModel& nominal, const StoredCalibration& calibration,
                RuntimeModel& model) {
  Eigen::Vector3d gravity = kGravity;
  if (calibration.held_root) {
    gravity = -kGravity.norm() * calibration.held_root->up;
  } else if (calibration.T_ref_waist) {
    ErrorModel placed = nominal;
    placed.T_ref_waist = *calibration.T_ref_waist;
    const Geometry geometry =
        ApplyErrors(placed, ErrorsByName(placed, calibration.joint_errors, calibration.externals));
    gravity = WaistPose(geometry).linear().transpose() * calibration.gravity;
  } else {
    return;
  }
  model.gravity.assign(gravity.begin(), gravity.end());
}

ec_foot MakeFoot(const Project& project, const StoredRobot& robot, const Leg& leg, bool elastic) {
  const Link& link = project.tree.links[static_cast<std::size_t>(leg.foot_link)];
  ec_foot foot{};
  foot.sole = {link.body, ToPose(link.T_body_link)};
  for (const Sole& sole : project.soles) {
    if (sole.link != leg.foot_link) continue;
    foot.centre[0] = sole.centre().x();
    foot.centre[1] = sole.centre().y();
  }
  const Eigen::Vector3d up = leg.R_floor_foot.transpose() * Eigen::Vector3d::UnitZ();
  for (int i = 0; i < 3; ++i) foot.up[i] = up[i];
  for (int i = 0; elastic && i < robot.model.parameter_count(); ++i) {
    const Parameter& parameter = robot.model.parameters[static_cast<std::size_t>(i)];
    const bool force = parameter.kind == ParameterKind::kLegForce;
    if (!force && parameter.kind != ParameterKind::kLegMoment) continue;
    if (robot.model.legs[static_cast<std::size_t>(parameter.leg)].link != leg.foot_link) continue;
    foot.compliance[parameter.axis + (force ? 0 : 3)] = robot.errors[i];
  }
  return foot;
}

/// The legs on which the robot can stand at run time: those with a sole in the project, or that
/// stood when the robot touched a table (contact.feet), or with a spring in the calibration, which
/// only a leg has that stood. The lowest chain may be an arm that hangs down.
std::vector<Leg> StandingLegs(const Project& project, const StoredCalibration& calibration,
                              const StoredRobot& robot) {
  std::vector<Leg> legs = FindLegs(project.tree, ChainNames(project));
  std::erase_if(legs, [&](const Leg& leg) {
    const bool touching =
        project.contact &&
        std::ranges::count(project.contact->setup.feet, leg.foot_link, &ContactFoot::link) > 0;
    const bool stood = touching ||
                       std::ranges::count(project.soles, leg.foot_link, &Sole::link) > 0 ||
                       std::ranges::count(robot.model.legs, leg.foot_link, &SupportLeg::link) > 0 ||
                       std::ranges::count(calibration.soles, leg.chain, &SoleSpring::leg) > 0;
    return !stood;
  });
  return legs;
}

/// Marks the bodies of each leg: those beyond its first joint that belongs to no other leg.
void MarkLegs(const RobotTree& tree, const std::vector<Leg>& legs, RuntimeModel& model) {
  model.leg_of_body.assign(model.mass.size(), -1);
  for (std::size_t i = 0; i < legs.size(); ++i) {
    for (int k : legs[i].joints) {
      const bool shared = std::any_of(legs.begin(), legs.end(), [&](const Leg& other) {
        return &other != &legs[i] &&
               std::find(other.joints.begin(), other.joints.end(), k) != other.joints.end();
      });
      if (!shared) model.leg_of_body[static_cast<std::size_t>(k) + 1] = static_cast<int>(i);
    }
  }
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    int& leg = model.leg_of_body[k + 1];
    if (leg < 0) leg = model.leg_of_body[static_cast<std::size_t>(tree.joints[k].parent_body)];
  }
}

/// Adds the compliance of the sole to that of its leg. The load in eq. 6 is that of the waist on
/// the leg, but the sole also bears the leg; the same factor holds for all postures and shares of
/// the weight (ec_leg_load).
void AddSoles(const StoredCalibration& calibration, RuntimeModel& model) {
  const double total = std::accumulate(model.mass.begin(), model.mass.end(), 0.0);
  for (const SoleSpring& sole : calibration.soles) {
    if (!sole.told()) continue;
    const auto name = std::ranges::find(model.foot_names, sole.leg);
    if (name == model.foot_names.end()) {
      throw InputError(calibration.source + ": soles: the robot has no leg '" + sole.leg + "'" +
                       DidYouMean(sole.leg, model.foot_names));
    }
    const int f = static_cast<int>(name - model.foot_names.begin());
    double leg = 0.0;
    for (std::size_t body = 0; body < model.mass.size(); ++body) {
      if (model.leg_of_body[body] == f) leg += model.mass[body];
    }
    ec_foot& foot = model.feet[Size(f)];
    Eigen::Index upright = 0;
    Eigen::Map<const Eigen::Vector3d>(foot.up).cwiseAbs().maxCoeff(&upright);
    foot.compliance[upright] += sole.compliance * total / (total - leg);
  }
}

void AddLimbs(const Project& project, const StoredRobot& robot, const std::vector<Leg>& legs,
              bool elastic, RuntimeModel& model) {
  for (const Leg& leg : legs) {
    model.foot_names.push_back(leg.chain);
    model.feet.push_back(MakeFoot(project, robot, leg, elastic));
  }
  MarkLegs(project.tree, legs, model);
  std::vector<int> known_tips;  // several chains may end there
  for (const Chain& chain : project.chains) {
    const Link& link = project.tree.links[static_cast<std::size_t>(chain.tip_link)];
    const bool known = std::ranges::count(known_tips, chain.tip_link) > 0;
    if (link.body == 0 || known) continue;
    known_tips.push_back(chain.tip_link);
    const auto leg = std::ranges::find(legs, chain.tip_link, &Leg::foot_link);
    ec_tip tip{};
    tip.frame = {link.body, ToPose(link.T_body_link)};
    tip.foot = leg == legs.end() ? -1 : static_cast<int>(leg - legs.begin());
    model.tip_names.push_back(chain.name);
    model.tips.push_back(tip);
  }
}

/// Whether the model has all joint parameters in the file.
bool HasAll(const ErrorModel& model, const StoredCalibration& calibration) {
  std::set<std::string> names;
  for (const Parameter& parameter : model.parameters) names.insert(parameter.name);
  return std::all_of(calibration.joint_errors.begin(), calibration.joint_errors.end(),
                     [&](const auto& error) { return names.contains(error.first); });
}

/// Adds a marker on each body at the end of the tree that has none, so that every joint moves one.
std::vector<Marker> WithMarkersAtEnds(const Project& project) {
  std::vector<Marker> markers = project.markers;
  std::set<int> others = {0};
  for (const Joint& joint : project.tree.joints) others.insert(joint.parent_body);
  for (const Marker& marker : project.markers)
    others.insert(project.tree.links[Size(marker.link)].body);
  for (std::size_t link = 0; link < project.tree.links.size(); ++link) {
    const int body = project.tree.links[link].body;
    if (!others.insert(body).second) continue;
    markers.push_back({"end of " + project.tree.links[link].name, static_cast<int>(link),
                       Eigen::Vector3d::Constant(0.1)});
  }
  return markers;
}

/// Throws InputError for a robot on balls, which roll where soles are taken to lie flat.
void CheckSolesAreFlat(const Project& project) {
  for (const Sole& sole : project.soles) {
    if (!sole.ball_radius) continue;
    throw InputError(project.file.string() + ": sole '" + project.tree.links[Size(sole.link)].name +
                     "' is a ball, and commands can be corrected for flat soles only; the "
                     "calibrated URDF serves such a robot");
  }
}

}  // namespace

StoredRobot RestoreRobot(const Project& project, const StoredCalibration& calibration) {
  const auto has = [&](const std::string& name) { return calibration.joint_errors.contains(name); };
  Elasticity elasticity;
  for (std::size_t k = 0; k < project.tree.joints.size(); ++k) {
    const std::string& name = project.tree.joints[k].name;
    if (has(name + ".compliance_z")) elasticity.torsion.push_back(static_cast<int>(k));
    if (has(name + ".compliance_x")) elasticity.bending.push_back(static_cast<int>(k));
    if (has(name + ".compliance_root_x")) elasticity.root_bending.push_back(static_cast<int>(k));
  }
  for (const Chain& chain : project.chains) {
    if (has(chain.name + ".compliance_x")) elasticity.legs.push_back({chain.name, chain.tip_link});
  }
  StoredRobot robot;
  robot.model = MakeErrorModel(project.tree, project.markers, project.placement, elasticity);
  // A robot that was calibrated by touches or other instruments has no markers on the observed
  // links.
  if (!HasAll(robot.model, calibration)) {
    robot.model =
        MakeErrorModel(project.tree, WithMarkersAtEnds(project), project.placement, elasticity);
  }
  if (calibration.nominal != NominalFingerprint(robot.model)) {
    throw InputError(calibration.source + ": made for robot '" + calibration.robot +
                     "' with other nominal geometry than " + project.urdf.string() +
                     "; expected the URDF that was calibrated, not the calibrated one");
  }
  std::vector<std::string> chains;
  for (const Chain& chain : project.chains) chains.push_back(chain.name);
  CheckParameters(calibration, robot.model, chains);
  robot.errors = Eigen::VectorXd::Zero(robot.model.parameter_count());
  for (int i = 0; i < robot.model.parameter_count(); ++i) {
    const Parameter& parameter = robot.model.parameters[static_cast<std::size_t>(i)];
    const auto found = calibration.joint_errors.find(parameter.name);
    if (!IsExternal(parameter.kind) && found != calibration.joint_errors.end()) {
      robot.errors[i] = found->second;
    }
  }
  return robot;
}

std::string NothingToCorrect() {
  return "no chain of the project ends at a link that moves, so that nothing says what is to be "
         "where the nominal robot has it; 'chains: [{name: NAME, tip: LINK}]' was expected";
}

std::string GravityThatDiffers(const StoredCalibration& calibration) {
  constexpr double kDegree = M_PI / 180.0, kAlike = 3.0 * kDegree;
  if (!calibration.held_root || calibration.held_root->differs <= kAlike) return "";
  return fmt::format(
      "The root link was held in attitudes that differ by up to {:.0f} deg from their mean. At run "
      "time a held root link has the mean: its deflections are right only where it is held so",
      calibration.held_root->differs / kDegree);
}

RuntimeModel MakeRuntimeModel(const Project& project, const StoredCalibration& calibration,
                              RuntimeContent content) {
  CheckHasNoLinkages(project, "the robot at run time");
  CheckSolesAreFlat(project);
  const bool rigid = content == RuntimeContent::kGeometry;
  const StoredRobot robot = RestoreRobot(project, rigid ? AsInUrdf(calibration) : calibration);
  RuntimeModel model;
  model.robot = project.tree.name;
  model.calibration = calibration.source;
  model.fingerprint = calibration.nominal;
  AddJoints(robot, content, model);
  AddLinks(project.tree, model);
  SetGravity(robot.model, calibration, model);
  if (content == RuntimeContent::kEverything) ApplyCauses(project.tree, calibration, model);
  AddLimbs(project, robot, StandingLegs(project, calibration, robot),
           content == RuntimeContent::kEverything, model);
  if (content == RuntimeContent::kEverything) AddSoles(calibration, model);
  FindBranches(model);
  return model;
}

}  // namespace elastocal
