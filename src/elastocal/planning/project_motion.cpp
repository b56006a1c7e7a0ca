// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/project_motion.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/validation_tours.hpp"
#include "elastocal/planning/chain_setups.hpp"

namespace elastocal {
namespace {

const std::string& JointName(const Project& project, int k) {
  return project.tree.joints[Size(k)].name;
}

}  // namespace

std::vector<SpherePair> AllContacts(const Project& project) {
  std::set<SpherePair> pairs;
  for (const ChainSetup& setup : SetupsOfBothSides(project)) {
    for (const auto& [a, b] : setup.contacts) pairs.insert(std::minmax(a, b));
  }
  return {pairs.begin(), pairs.end()};
}

std::unique_ptr<StandingRobot> StandProjectRobot(const Project& project,
                                                 const MotionLimits& limits) {
  for (const ChainSetup& setup : project.motion.chains) {
    if (!project.soles.empty() || setup.support.empty()) continue;
    throw InputError(project.file.string() + ": chain '" + setup.name +
                     "' of the section 'design' stands on feet, but there is no section 'standing' "
                     "with their soles");
  }
  // Postures may be designed exactly at the margin.
  constexpr double kShareOfMargin = 0.8;
  auto robot = std::make_unique<StandingRobot>(project.tree, project.soles, limits);
  robot->limits.clearance = kShareOfMargin * project.motion.sphere_margin;
  const std::vector<SpherePair> pairs = AllContacts(project);
  if (!pairs.empty()) {
    robot->clearances = [&tree = robot->tree, spheres = project.motion.spheres,
                         pairs](const Eigen::VectorXd& q) {
      return SphereDistances(spheres, pairs, LinkTransforms(tree, q));
    };
  }
  StandOptions options;
  options.stance = project.stance;
  StandUp(*robot, project.motion.rest, options);
  return robot;
}

std::vector<std::string> ContactNames(const Project& project) {
  std::vector<std::string> names;
  for (const auto& [a, b] : AllContacts(project)) {
    names.push_back(project.motion.spheres[Size(a)].name + " and " +
                    project.motion.spheres[Size(b)].name);
  }
  if (!project.contact) return names;
  for (std::size_t plate = 0; plate < project.contact->tables.size(); ++plate) {
    if (!project.contact->tables[plate]) continue;
    names.push_back("the table of " + project.contact->setup.plates[plate].name +
                    " (limit: touch)");
  }
  return names;
}

std::vector<PostureTour> PostureTours(const StandingRobot& robot,
                                      const std::vector<ChainPostures>& chains) {
  std::vector<PostureTour> sets;
  for (const ChainPostures& chain : chains) {
    PostureTour set{chain.chain, {}, chain.q, false, {}};
    set.standing = FeetOf(robot, chain.support);
    sets.push_back(std::move(set));
  }
  return sets;
}

JointMotion ToJointMotion(const StandingRobot& robot, const SampledMotion& motion) {
  JointMotion result;
  result.q = motion.q;
  result.time_s = Eigen::VectorXd::LinSpaced(
      motion.q.rows(), 0.0, static_cast<double>(motion.q.rows() - 1) / motion.rate_hz);
  for (const std::vector<int>& standing : motion.standing) {
    std::vector<int> links;
    for (const int foot : standing) links.push_back(robot.soles[Size(foot)].link);
    result.support.push_back(std::move(links));
  }
  return result;
}

std::string ReasonText(const Project& project, const LeftOut& left_out) {
  std::string text = ConstraintName(left_out.constraint);
  switch (left_out.constraint) {
    case Constraint::kPosition: {
      const bool slides = project.tree.joints[Size(left_out.index)].type == JointType::kPrismatic;
      return text + fmt::format(": {} {:.2f} {} from its end", JointName(project, left_out.index),
                                left_out.value * (slides ? 1e3 : 1.0 / kRadiansPerDegree),
                                slides ? "mm" : "deg");
    }
    case Constraint::kVelocity:
    case Constraint::kTorque:
      return text + fmt::format(": {} at {:.0f} %", JointName(project, left_out.index),
                                100.0 * left_out.value);
    case Constraint::kClearance:
      return text + fmt::format(": {} {:.1f} mm apart", ContactNames(project)[Size(left_out.index)],
                                1e3 * left_out.value);
    case Constraint::kZmp:
    case Constraint::kFeet:
    case Constraint::kFloor:
      return text + fmt::format(": {:.1f} mm", 1e3 * left_out.value);
    case Constraint::kFriction:
    case Constraint::kKnee:
      return text + fmt::format(": {:.2f}", left_out.value);
    case Constraint::kLever:
      return text + fmt::format(": {} at {:.0f} %",
                                project.tree.linkages[Size(left_out.index)].name,
                                100.0 * left_out.value);
    case Constraint::kReach:
    case Constraint::kApproach:
      break;
  }
  return text;
}

}  // namespace elastocal
