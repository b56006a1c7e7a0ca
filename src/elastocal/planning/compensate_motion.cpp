// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/compensate_motion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/link_zmp.hpp"
#include "elastocal/motion/motion_check.hpp"
#include "elastocal/planning/project_motion.hpp"
#include "elastocal/planning/stopped_joints.hpp"
#include "elastocal/robot/collision.hpp"
#include "elastocal/robot/coordinates.hpp"

namespace elastocal {
namespace {

double TimeAt(const JointMotion& motion, Eigen::Index i) {
  return motion.time_s.size() > 0 ? motion.time_s[i] : static_cast<double>(i);
}

void KeepSmaller(double value, double time_s, const std::string& where, MotionExtreme& extreme) {
  if (value < extreme.value) extreme = {value, time_s, where};
}

/// The standing robot with the feet of a sampled motion, for inverse dynamics and clearances.
SampledMotion ToSampled(const StandingRobot& robot, const JointMotion& motion) {
  SampledMotion sampled;
  sampled.q = motion.q;
  const Eigen::Index last = motion.time_s.size() - 1;
  sampled.rate_hz = static_cast<double>(last) / (motion.time_s[last] - motion.time_s[0]);
  for (const std::vector<int>& links : motion.support) {
    std::vector<int> feet;
    for (std::size_t f = 0; f < robot.soles.size(); ++f) {
      if (std::count(links.begin(), links.end(), robot.soles[f].link) > 0) {
        feet.push_back(static_cast<int>(f));
      }
    }
    sampled.standing.push_back(std::move(feet));
  }
  return sampled;
}

/// Whether the samples are at equal intervals, within a tenth: accelerations are differences of
/// second order.
bool IsEvenlySampled(const JointMotion& motion) {
  const Eigen::Index last = motion.time_s.size() - 1;
  const double mean = (motion.time_s[last] - motion.time_s[0]) / static_cast<double>(last);
  const Eigen::ArrayXd steps = motion.time_s.tail(last) - motion.time_s.head(last);
  return (steps - mean).abs().maxCoeff() <= 0.1 * mean;
}

bool CanBeChecked(const Project& project, const JointMotion& motion) {
  const bool stands = std::all_of(motion.support.begin(), motion.support.end(),
                                  [](const std::vector<int>& links) { return !links.empty(); });
  return !project.soles.empty() && motion.time_s.size() > 2 && !motion.support.empty() && stands;
}

/// By coordinate: largest speed that its joint and those that follow it allow. A follower's limit
/// of zero says nothing.
Eigen::VectorXd LargestSpeeds(const RobotTree& tree) {
  Eigen::VectorXd speeds(tree.coordinate_count());
  for (Eigen::Index c = 0; c < speeds.size(); ++c) {
    speeds[c] = tree.joints[Size(tree.coordinate_joint[Size(c)])].limits.velocity;
  }
  for (const Joint& joint : tree.joints) {
    if (!joint.mimic || joint.multiplier == 0.0 || joint.limits.velocity <= 0.0) continue;
    speeds[joint.coordinate] =
        std::min(speeds[joint.coordinate], joint.limits.velocity / std::abs(joint.multiplier));
  }
  return speeds;
}

void CheckLimits(const Project& project, CompensatedMotion& result) {
  const JointMotion& motion = result.planned.motion;
  result.position.value = std::numeric_limits<double>::infinity();
  const Eigen::VectorXd speeds = LargestSpeeds(project.tree);
  for (Eigen::Index c = 0; c < motion.q.cols(); ++c) {
    const std::string& name = JointOfCoordinate(project.tree, c).name;
    const JointLimits& limits = project.tree
                                    .joints[static_cast<std::size_t>(
                                        project.tree.coordinate_joint[static_cast<std::size_t>(c)])]
                                    .limits;
    for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
      const double q = motion.q(i, c);
      KeepSmaller(std::min(q - limits.lower, limits.upper - q), TimeAt(motion, i), name,
                  result.position);
      if (i == 0 || motion.time_s.size() == 0) continue;
      const double speed =
          std::abs(q - motion.q(i - 1, c)) / (motion.time_s[i] - motion.time_s[i - 1]);
      KeepLarger(speed / speeds[c], motion.time_s[i], name, result.velocity);
    }
  }
  const auto refuse = [&](const char* what, const MotionExtreme& at, double scale, const char* unit,
                          const char* advice) {
    result.broken.push_back(fmt::format("{}: {} {:.3g} {} at {:.2f} s; {}", what, at.where,
                                        scale * at.value, unit, at.time_s, advice));
  };
  constexpr double kRounding = 1e-9;
  if (result.position.value < -kRounding) {
    const int joint = FindJoint(project.tree, result.position.where);
    const bool slides =
        project.tree.joints[static_cast<std::size_t>(joint)].type == JointType::kPrismatic;
    refuse("beyond a joint's limit", result.position, slides ? 1e3 : 180.0 / M_PI,
           slides ? "mm" : "deg", "plan it within the limit");
  }
  if (result.velocity.value > 1.0)
    refuse("faster than a joint's limit", result.velocity, 100.0, "%",
           "plan it slower, or its limb less stretched there");
  if (result.has_clearance && result.clearance.value < 0.0) {
    refuse("parts touch", result.clearance, 1e3, "mm",
           "design and plan again with more room there (collision.margin_mm of the project)");
  }
}

/// Judges the deviations. `reasons` names the limits that cause them.
void JudgeLeft(std::vector<std::string> reasons, const CompensateMotionOptions& options,
               CompensatedMotion& result) {
  std::vector<std::string> exceeded;
  for (const LeftAtLimb& one : result.left) {
    if (one.yields) continue;
    std::ranges::move(Exceeded(one, options.most_left_m, options.most_turned_rad),
                      std::back_inserter(exceeded));
  }
  if (exceeded.empty()) {
    std::ranges::move(reasons, std::back_inserter(result.warnings));
    return;
  }
  result.broken = std::move(reasons);
  std::ranges::move(exceeded, std::back_inserter(result.broken));
}

/// Computes distances of the calibrated robot's parts.
class CalibratedClearance {
 public:
  explicit CalibratedClearance(const Project& project)
      : spheres_(project.motion.spheres),
        pairs_(AllContacts(project)),
        names_(ContactNames(project)) {}

  bool empty() const { return pairs_.empty(); }

  void Look(const std::vector<Transform>& T_root_link, double time_s, MotionExtreme& least) const {
    if (empty()) return;
    Eigen::Index nearest = 0;
    const double distance = SphereDistances(spheres_, pairs_, T_root_link).minCoeff(&nearest);
    KeepSmaller(distance, time_s, names_[static_cast<std::size_t>(nearest)], least);
  }

 private:
  const std::vector<CollisionSphere>& spheres_;
  std::vector<SpherePair> pairs_;
  std::vector<std::string> names_;
};

/// Computes the zero-moment point of the plan and of the calibrated robot, with masses as
/// described. The root link follows the plan, because hands and feet do.
class CalibratedBalance {
 public:
  CalibratedBalance(const StandingRobot& robot, const SampledMotion& motion, MotionForces planned)
      : robot_(robot),
        standing_(motion.standing),
        planned_(std::move(planned)),
        step_(1.0 / motion.rate_hz),
        follow_(robot.tree, step_),
        zmp_(planned_.zmp) {}

  /// Examines the next sample.
  void Look(std::vector<Transform> T_root_link) {
    const Transform& T_world_root = planned_.T_world_root[Size(taken_)];
    for (Transform& T : T_root_link) T = T_world_root * T;
    const std::optional<Eigen::Vector2d> before = follow_.Next(T_root_link);
    if (before) zmp_.row(taken_ - 1) = before->transpose();
    ++taken_;
  }

  /// Stores the result after the last sample.
  void Store(CompensatedMotion& result) {
    zmp_.row(taken_ - 1) = follow_.Last().transpose();
    result.has_zmp = true;
    result.planned_zmp = Least(planned_.zmp, result.planned.motion);
    result.zmp = Least(zmp_, result.planned.motion);
    if (result.zmp.value >= std::min(robot_.limits.zmp_margin, result.planned_zmp.value)) return;
    // If the plan itself leaves the support, that is due to its planner, or to wrong masses.
    const bool leaves = result.zmp.value < 0.0 && result.planned_zmp.value >= 0.0;
    (leaves ? result.broken : result.warnings)
        .push_back(fmt::format("the zero-moment point is {:.1f} mm {} the edge of the support at "
                               "{:.2f} s, of the plan "
                               "{:.1f} mm, and 'plan' asks for {:.1f} mm; {}",
                               1e3 * std::abs(result.zmp.value),
                               result.zmp.value < 0.0 ? "beyond" : "from", result.zmp.time_s,
                               1e3 * result.planned_zmp.value, 1e3 * robot_.limits.zmp_margin,
                               "plan limbs less stretched there, or slower"));
  }

 private:
  MotionExtreme Least(const Eigen::MatrixX2d& zmp, const JointMotion& motion) const {
    const Worst least = LeastAverageZmp(robot_, standing_, zmp, step_);
    return {least.value, TimeAt(motion, least.sample)};
  }

  const StandingRobot& robot_;
  const std::vector<std::vector<int>> standing_;
  const MotionForces planned_;
  const double step_;
  LinkZmp follow_;
  Eigen::Index taken_ = 0;
  Eigen::MatrixX2d zmp_;
};

/// Torques by joint from those by coordinate in the plan; NaN (statics) for joints that share a
/// coordinate, whose torque is the sum of theirs.
Eigen::VectorXd JointTorques(const RobotTree& tree, const Eigen::VectorXd& by_coordinate) {
  Eigen::VectorXd torques = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(tree.joints.size()),
                                                      std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index c = 0; c < by_coordinate.size(); ++c) {
    torques[tree.coordinate_joint[static_cast<std::size_t>(c)]] = by_coordinate[c];
  }
  for (const Joint& joint : tree.joints) {
    if (!joint.mimic) continue;
    for (const Drive& drive : DrivesOf(joint)) {
      torques[tree.coordinate_joint[Size(drive.coordinate)]] =
          std::numeric_limits<double>::quiet_NaN();
    }
  }
  return torques;
}

}  // namespace

StandingFeet FeetOfLinks(const Project& project, const RuntimeModel& model,
                         const std::vector<int>& links) {
  StandingFeet feet = 0;
  for (int link : links) {
    const std::string& name = project.tree.links[static_cast<std::size_t>(link)].name;
    bool found = false;
    for (std::size_t f = 0; f < model.foot_names.size(); ++f) {
      const Chain& chain =
          project.chains[static_cast<std::size_t>(FindChain(project, model.foot_names[f]))];
      if (chain.tip_link != link) continue;
      feet |= StandingFeet{1} << f;
      found = true;
    }
    if (!found)
      throw InputError("support '" + name +
                       "': it is no foot of the robot; feet are the links of 'standing: "
                       "{soles: [...]}' of the project");
  }
  return feet;
}

std::vector<std::string> OpenJoints(const Project& project, const JointMotion& motion) {
  std::vector<std::string> names;
  for (Eigen::Index c = 0; c < motion.q.cols(); ++c) {
    if (!motion.q.col(c).array().isNaN().all()) continue;
    names.push_back(JointOfCoordinate(project.tree, c).name);
  }
  return names;
}

JointMotion WithOpenJointsAtRest(const Project& project, JointMotion motion) {
  for (Eigen::Index c = 0; c < motion.q.cols(); ++c) {
    if (!motion.q.col(c).array().isNaN().all()) continue;
    motion.q.col(c).setConstant(project.motion.rest[c]);
  }
  return motion;
}

namespace {

/// Throws InputError for a robot whose commands cannot be corrected.
void CheckCanBeCorrected(const Project& project, const RuntimeModel& model) {
  if (model.tips.empty()) {
    throw InputError(project.file.string() + ": " + NothingToCorrect());
  }
}

/// The robot for which the plan was made, standing, with its motion; empty where that is unknown.
struct PlannedBalance {
  std::unique_ptr<StandingRobot> robot;
  std::optional<CalibratedBalance> balance;
};

/// Stores zero-moment point and torques of the plan in the result, where they are known.
PlannedBalance BalanceOfPlan(const Project& project, const JointMotion& planned, MotionLoads loads,
                             CompensatedMotion& result) {
  PlannedBalance of;
  const bool can_be_checked = CanBeChecked(project, planned);
  if (can_be_checked && !IsEvenlySampled(planned)) {
    const std::string uneven = "intervals between the plan's samples differ by more than a tenth";
    if (loads == MotionLoads::kPlanned) {
      throw InputError(planned.source + ": " + uneven +
                       ", and torques need its accelerations; sample it evenly");
    }
    result.warnings.push_back(uneven + ": its balance was not checked; sample it evenly");
    return of;
  }
  if (can_be_checked) {
    of.robot = StandProjectRobot(project, {});
    MotionForces forces;
    const SampledMotion sampled = ToSampled(*of.robot, planned);
    CheckMotion(*of.robot, sampled, &forces);
    result.planned.zmp = forces.zmp;
    result.planned.torques = forces.torques;
    of.balance.emplace(*of.robot, sampled, std::move(forces));
  } else if (loads == MotionLoads::kPlanned) {
    throw InputError(planned.source +
                     ": torques of the plan need its times and support, and the project's soles");
  }
  return of;
}

}  // namespace

CompensatedMotion CompensateMotion(const Project& project, const RuntimeModel& model,
                                   const JointMotion& given,
                                   const CompensateMotionOptions& options) {
  CheckCanBeCorrected(project, model);
  CompensatedMotion result;
  result.at_rest = OpenJoints(project, given);
  const JointMotion planned = WithOpenJointsAtRest(project, given);
  result.planned.motion = planned;
  JointMotion& motion = result.planned.motion;
  PlannedBalance of_plan = BalanceOfPlan(project, planned, options.loads, result);
  std::optional<CalibratedBalance>& balance = of_plan.balance;
  Compensator compensator(model, options.limits);
  CalibratedClearance clearance(project);
  result.has_clearance = !clearance.empty();
  result.clearance.value = std::numeric_limits<double>::infinity();
  // Without soles the root link is held, as 'plan' does.
  const StandingFeet all = project.soles.empty() ? 0 : (StandingFeet{1} << model.feet.size()) - 1;
  CompensatorStatus status = 0;
  std::string cut;  // since when a deflection is beyond its limit
  StoppedJoints stopped(project.tree);
  result.left = NothingLeft(model);
  constexpr double kShare = 1.0 - 1e-6;  // room for the rounding in the file
  const Eigen::VectorXd speeds = kShare * LargestSpeeds(project.tree);
  Eigen::VectorXd torque;
  std::vector<Transform> T_root_link(project.tree.links.size());
  for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
    const Eigen::VectorXd nominal = planned.q.row(i).transpose();
    const StandingFeet feet =
        planned.support.empty()
            ? all
            : FeetOfLinks(project, model, planned.support[static_cast<std::size_t>(i)]);
    if (options.loads == MotionLoads::kPlanned) {
      torque = JointTorques(project.tree, result.planned.torques.row(i).transpose());
    }
    if (i > 0 && planned.time_s.size() > 0) {
      const double step = planned.time_s[i] - planned.time_s[i - 1];
      compensator.LimitChanges(step * speeds);
      compensator.EaseChanges(options.ease_s / step);
    }
    const CompensatorStatus now = compensator.Command(nominal, torque, feet);
    if (cut.empty() && (now & EC_DEFLECTION_CUT) != 0) {
      cut = fmt::format(" from {:.2f} s on (limits: {:.3g} deg and {:.3g} mm)", TimeAt(planned, i),
                        options.limits.largest_turn_rad * 180.0 / M_PI,
                        1e3 * options.limits.largest_shift_m);
    }
    status |= now;
    stopped.Look(compensator, TimeAt(planned, i));
    LookAtLimbs(compensator, TimeAt(planned, i), result.left);
    motion.q.row(i) = compensator.command().transpose();
    result.residual_m = std::max(result.residual_m, compensator.residual_m());
    result.residual_rad = std::max(result.residual_rad, compensator.residual_rad());
    Eigen::Index joint = 0;
    const double change = (compensator.command() - nominal).cwiseAbs().maxCoeff(&joint);
    KeepLarger(change, TimeAt(planned, i), JointOfCoordinate(project.tree, joint).name,
               result.correction);
    compensator.Forward(compensator.command(), torque, feet);
    for (std::size_t link = 0; link < T_root_link.size(); ++link) {
      T_root_link[link] = compensator.link_pose(static_cast<int>(link));
    }
    clearance.Look(T_root_link, TimeAt(planned, i), result.clearance);
    if (balance) balance->Look(T_root_link);
  }
  JudgeLeft(stopped.Describe(static_cast<int>(motion.q.rows())), options, result);
  if (balance) balance->Store(result);
  status &= ~CompensatorStatus{EC_JOINT_LIMIT | EC_CORRECTION_CUT};
  if (status != 0) result.broken.push_back(DescribeStatus(status) + cut);
  CheckLimits(project, result);
  return result;
}

}  // namespace elastocal
