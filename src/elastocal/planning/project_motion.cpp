#include "elastocal/planning/project_motion.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "elastocal/planning/chain_setups.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/motion/validation_tours.hpp"

namespace elastocal {
namespace {

std::size_t Size(int i) { return static_cast<std::size_t>(i); }

/// Pairs of spheres of all chains and of those on the other side, each once.
std::vector<SpherePair> AllContacts(const Project& project) {
  std::set<SpherePair> pairs;
  for (const ChainSetup& setup : SetupsOfBothSides(project)) {
    for (const auto& [a, b] : setup.contacts) pairs.insert(std::minmax(a, b));
  }
  return {pairs.begin(), pairs.end()};
}

const std::string& JointName(const Project& project, int k) {
  return project.tree.joints[Size(k)].name;
}

}  // namespace

std::unique_ptr<StandingRobot> StandProjectRobot(const Project& project,
                                                 const MotionLimits& limits) {
  if (project.soles.empty()) {
    throw InputError(project.file.string() +
                     ": no section 'standing' with the soles that the robot stands on");
  }
  // Postures may be designed right at the margin.
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
  StandUp(*robot, project.motion.rest, {});
  return robot;
}

std::vector<std::string> ContactNames(const Project& project) {
  std::vector<std::string> names;
  for (const auto& [a, b] : AllContacts(project)) {
    names.push_back(project.motion.spheres[Size(a)].name + " and " +
                    project.motion.spheres[Size(b)].name);
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

std::vector<PostureTour> ProjectValidationTours(const Project& project, const StandingRobot& robot,
                                                const std::string& kind, std::uint64_t seed) {
  Random random(seed);
  const ValidationKind which = kind == "sine"     ? ValidationKind::kSine
                               : kind == "random" ? ValidationKind::kRandom
                                                  : ValidationKind::kRepeatability;
  return ValidationTours(robot, project.motion, SetupsOfBothSides(project), which, {}, random);
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
    case Constraint::kPosition:
      return text + fmt::format(": {} {:.4f} from its end", JointName(project, left_out.index),
                                left_out.value);
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
    case Constraint::kReach:
      break;
  }
  return text;
}

std::string MarginTable(const Project& project, const MotionMargins& margins,
                        const MotionLimits& limits, double rate_hz) {
  TextTable table({"over all samples", "worst", "limit", "at s", "where"});
  const auto add = [&](const std::string& what, const Worst& worst, const std::string& value,
                       const std::string& limit, const std::string& where) {
    if (worst.sample < 0) return;
    table.Add({what, value, limit, fmt::format("{:.2f}", worst.sample / rate_hz), where});
  };
  const auto joint = [&](const Worst& worst) { return JointName(project, worst.index); };
  const auto sole = [&](const Worst& worst) {
    return project.tree.links[Size(project.soles[Size(worst.index)].link)].name;
  };
  const auto mm = [](double metres) { return fmt::format("{:.1f}", 1e3 * metres); };
  const auto percent = [](double share) { return fmt::format("{:.0f}", 100.0 * share); };
  if (margins.clearance.sample >= 0) {
    add("least distance of parts, mm", margins.clearance, mm(margins.clearance.value),
        mm(limits.clearance), ContactNames(project)[Size(margins.clearance.index)]);
  }
  add("zero-moment point to edge, mm", margins.zmp, mm(margins.zmp.value), mm(limits.zmp_margin),
      "");
  add("torque, % of limit", margins.torque, percent(margins.torque.value),
      percent(limits.torque_share), joint(margins.torque));
  add("velocity, % of limit", margins.velocity, percent(margins.velocity.value),
      percent(limits.velocity_share), joint(margins.velocity));
  add("joint to end of range, deg", margins.position,
      fmt::format("{:.2f}", margins.position.value * 180.0 / M_PI),
      fmt::format("{:.2f}", limits.position_margin * 180.0 / M_PI), joint(margins.position));
  add("acceleration, rad/s^2", margins.acceleration,
      fmt::format("{:.1f}", margins.acceleration.value), "", joint(margins.acceleration));
  add("horizontal over vertical force", margins.friction,
      fmt::format("{:.3f}", margins.friction.value), fmt::format("{:.1f}", limits.friction), "");
  add("knee of a standing leg, rad", margins.knee, fmt::format("{:.2f}", margins.knee.value),
      fmt::format("{:.2f}", limits.least_knee), sole(margins.knee));
  add("standing foot moves, m", margins.foot_moved, fmt::format("{:.0e}", margins.foot_moved.value),
      "1e-06", sole(margins.foot_moved));
  add("standing foot turns, rad", margins.foot_turned,
      fmt::format("{:.0e}", margins.foot_turned.value), "1e-06", sole(margins.foot_turned));
  return table.Render();
}

}  // namespace elastocal
