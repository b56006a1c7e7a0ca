// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/plan_motion.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/parallel.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/planning/chain_setups.hpp"
#include "elastocal/planning/project_motion.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/planning/stand_at_tables.hpp"
#include "elastocal/planning/touch_motion.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {
namespace {

constexpr double kLeadIn = 5.0;  // at rest before the first set, s

void CheckPlanOptions(const MotionPlanOptions& options) {
  const auto expect = [](bool fine, const char* what, double found, const char* expected) {
    if (!fine) throw InputError(fmt::format("{}: found {}; expected {}", what, found, expected));
  };
  const MotionLimits& limits = options.limits;
  const char* share = "a share above 0 and up to 1";
  const double torque_share = options.torque_share.value_or(1.0);
  expect(torque_share > 0.0 && torque_share <= 1.0, "share of the torque limits", torque_share,
         share);
  expect(limits.velocity_share > 0.0 && limits.velocity_share <= 1.0,
         "share of the velocity limits", limits.velocity_share, share);
  expect(!std::isnan(limits.zmp_margin), "margin of the zero-moment point", limits.zmp_margin,
         "a number");
  expect(options.plan.path.duration_s > 0.0, "time between two postures",
         options.plan.path.duration_s, "more than 0");
  expect(options.plan.hold_s >= 1.0, "time at rest in a posture", options.plan.hold_s,
         "1 s or more");
}

/// Lists the worst values of a motion with their limits.
class LimitList {
 public:
  LimitList(const Project& project, const MotionMargins& margins, const MotionLimits& limits,
            double rate_hz)
      : project_(project), rate_hz_(rate_hz), broken_(BrokenConstraints(margins, limits)) {}

  /// `limit` is empty where there is none.
  void Add(const char* what, const Worst& worst, const std::string& value, const std::string& limit,
           const std::string& where, Constraint constraint) {
    if (worst.sample < 0) return;
    const bool broken = !limit.empty() && std::count(broken_.begin(), broken_.end(), constraint);
    uses.push_back({what, value, limit, worst.sample / rate_hz_, where, broken});
  }

  std::string Joint(const Worst& worst) const {
    return worst.index < 0 ? "" : project_.tree.joints[Size(worst.index)].name;
  }
  std::string Sole(const Worst& worst) const {
    if (worst.index < 0) return "";
    const int link = project_.soles[Size(worst.index)].link;
    return project_.tree.links[Size(link)].name;
  }
  std::string Linkage(const Worst& worst) const {
    return worst.index < 0 ? "" : project_.tree.linkages[Size(worst.index)].name;
  }
  std::string Parts(const Worst& worst) const {
    return worst.index < 0 ? "" : ContactNames(project_)[Size(worst.index)];
  }

  std::vector<LimitUse> uses;

 private:
  const Project& project_;
  double rate_hz_;
  std::vector<Constraint> broken_;
};

std::vector<LimitUse> LimitUses(const Project& project, const MotionMargins& margins,
                                const MotionLimits& limits, double rate_hz) {
  // Without the minus of a value that rounds to zero.
  const auto mm = [](double metres) {
    return fmt::format("{:.1f}", std::round(1e4 * metres) / 10.0 + 0.0);
  };
  const auto percent = [](double share) { return fmt::format("{:.0f}", 100.0 * share); };
  const auto degrees = [](double angle) { return fmt::format("{:.2f}", angle * 180.0 / M_PI); };
  const auto tiny = [](double value) { return fmt::format("{:.0e}", value); };
  LimitList list(project, margins, limits, rate_hz);
  list.Add("least distance of parts, mm", margins.clearance, mm(margins.clearance.value),
           mm(limits.clearance), list.Parts(margins.clearance), Constraint::kClearance);
  list.Add("zero-moment point to edge, mm", margins.zmp, mm(margins.zmp.value),
           mm(limits.zmp_margin), "", Constraint::kZmp);
  list.Add("torque, % of limit", margins.torque, percent(margins.torque.value),
           percent(limits.torque_share), list.Joint(margins.torque), Constraint::kTorque);
  list.Add("velocity, % of limit", margins.velocity, percent(margins.velocity.value),
           percent(limits.velocity_share), list.Joint(margins.velocity), Constraint::kVelocity);
  const bool slides =
      margins.position.index >= 0 &&
      project.tree.joints[Size(margins.position.index)].type == JointType::kPrismatic;
  list.Add(slides ? "joint to end of range, mm" : "joint to end of range, deg", margins.position,
           slides ? mm(margins.position.value) : degrees(margins.position.value),
           slides ? mm(limits.position_margin) : degrees(limits.position_margin),
           list.Joint(margins.position), Constraint::kPosition);
  list.Add("acceleration, rad/s^2", margins.acceleration,
           fmt::format("{:.1f}", margins.acceleration.value), "", list.Joint(margins.acceleration),
           Constraint::kVelocity);
  list.Add("horizontal over vertical force", margins.friction,
           fmt::format("{:.3f}", margins.friction.value), fmt::format("{:.1f}", limits.friction),
           "", Constraint::kFriction);
  list.Add("knee of a standing leg, rad", margins.knee, fmt::format("{:.2f}", margins.knee.value),
           fmt::format("{:.2f}", limits.least_knee), list.Sole(margins.knee), Constraint::kKnee);
  list.Add("standing foot moves, m", margins.foot_moved, tiny(margins.foot_moved.value),
           tiny(kFootTolerance), list.Sole(margins.foot_moved), Constraint::kFeet);
  list.Add("standing foot turns, rad", margins.foot_turned, tiny(margins.foot_turned.value),
           tiny(kFootTolerance), list.Sole(margins.foot_turned), Constraint::kFeet);
  list.Add("swinging foot above the floor, mm", margins.floor, mm(margins.floor.value), mm(0.0),
           list.Sole(margins.floor), Constraint::kFloor);
  if (!project.tree.linkages.empty()) {
    list.Add("lever of rods, % of where put together", margins.lever, percent(margins.lever.value),
             percent(limits.lever_share), list.Linkage(margins.lever), Constraint::kLever);
  }
  return std::move(list.uses);
}

std::string DescribeLeftOut(const Project& project, const PlannedTour& set, const LeftOut& left) {
  const std::string what = left.sine >= 0
                               ? "sine of " + JointOfCoordinate(project.tree, left.sine).name
                               : fmt::format("posture {}", left.posture + 1);
  return fmt::format("{}, {} is left out: {} ({})", set.name, what, ReasonText(project, left),
                     left.at_rest ? "at rest" : "on every way there");
}

/// Describes joints that leave the project's range by a clear part of the default range of
/// postures.
std::vector<std::string> DescribeBeyondRanges(const Project& project, const JointMotion& motion) {
  constexpr double kPlainly = 0.01;  // share of a range
  constexpr double kTolerance = 1e-6;
  std::vector<std::string> beyond;
  for (Eigen::Index c = 0; c < motion.q.cols(); ++c) {
    const Joint& joint = JointOfCoordinate(project.tree, c);
    const auto [widest_lower, widest_upper] = PostureRange(joint, kUsualLimitMargin);
    const double lower = project.motion.lower[c], upper = project.motion.upper[c];
    const double plainly = kPlainly * (widest_upper - widest_lower);
    Eigen::Index below = 0, above = 0;
    const double under = lower - motion.q.col(c).minCoeff(&below);
    const double over = motion.q.col(c).maxCoeff(&above) - upper;
    const bool is_low = lower > widest_lower + plainly && under > kTolerance && under >= over;
    const bool is_high = upper < widest_upper - plainly && over > kTolerance && !is_low;
    if (!is_low && !is_high) continue;
    const bool slides = joint.type == JointType::kPrismatic;
    const double unit = slides ? 1e3 : 180.0 / M_PI;
    beyond.push_back(fmt::format(
        "{} leaves the range that the project asks for (design: range_deg, limit_margin) by "
        "{:.2f} {} at {:.2f} s: postures keep it, and the motion goes on to keep its balance; "
        "--limit-margin-deg holds for the whole motion",
        joint.name, unit * (is_low ? under : over), slides ? "mm" : "deg",
        motion.time_s[is_low ? below : above]));
  }
  return beyond;
}

/// The robot for the motion: between tables, if the project has some.
std::unique_ptr<StandingRobot> StandForMotion(const Project& project,
                                              const MotionPlanOptions& options) {
  MotionLimits limits = options.limits;
  limits.torque_share = options.torque_share.value_or(project.motion.motion_effort_share);
  if (!project.contact) return StandProjectRobot(project, limits);
  ObservationSetup setup = project.contact->setup;
  return StandAtTables(project, limits, setup);
}

/// Whether no posture of the set can be held and reached.
bool IsImpossible(const PlannedTour& set) {
  return set.motion.q.rows() == 0 ||
         (set.visits.empty() && !set.left_out.empty() && set.left_out[0].posture >= 0);
}

MotionPlan PlanSets(const Project& project, const StandingRobot& robot,
                    std::vector<PostureTour> sets, const MotionPlanOptions& options,
                    const Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  MotionPlan plan;
  plan.sets = std::move(sets);
  plan.rate_hz = options.plan.rate_hz;
  plan.planned = PlanTours(robot, plan.sets, options.plan, options.threads, progress);
  for (const PlannedTour& set : plan.planned) {
    if (IsImpossible(set)) plan.impossible.push_back(set.name);
    for (const LeftOut& left : set.left_out) {
      plan.left_out.push_back(DescribeLeftOut(project, set, left));
    }
  }
  const SampledMotion motion = JoinMotions(robot, plan.planned, kLeadIn, plan.rate_hz);
  MotionForces forces;
  plan.margins = CheckMotion(robot, motion, &forces);
  plan.limits = LimitUses(project, plan.margins, robot.limits, plan.rate_hz);
  plan.whole = {ToJointMotion(robot, motion), forces.zmp, forces.torques};
  plan.beyond_ranges = DescribeBeyondRanges(project, plan.whole.motion);
  plan.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return plan;
}

}  // namespace

std::string LimitUse::Describe() const {
  return fmt::format("{}: {} at {:.2f} s{}, the limit is {}", what, worst, time_s,
                     where.empty() ? "" : " (" + where + ")", limit);
}

std::vector<LimitUse> MotionPlan::broken() const {
  std::vector<LimitUse> found;
  for (const LimitUse& use : limits) {
    if (use.broken) found.push_back(use);
  }
  return found;
}

MotionPlan PlanMotion(const Project& project, const std::vector<ChainPostures>& postures,
                      const MotionPlanOptions& options, const Progress& progress) {
  CheckPlanOptions(options);
  const auto robot = StandForMotion(project, options);
  std::vector<PostureTour> tours =
      project.contact
          ? TouchTours(project, *robot, postures, options.approach, options.plan.rate_hz)
          : PostureTours(*robot, postures);
  return PlanSets(project, *robot, std::move(tours), options, progress);
}

MotionPlan PlanValidationMotion(const Project& project, ValidationKind kind, std::uint64_t seed,
                                const MotionPlanOptions& options, const Progress& progress) {
  CheckPlanOptions(options);
  ChosenSetups(project, {});  // throws where there is no section `design`
  const auto robot = StandForMotion(project, options);
  Random random(seed);
  std::vector<PostureTour> tours = ValidationTours(
      *robot, project.motion, SetupsOfBothSides(project), kind, options.validation, random);
  return PlanSets(project, *robot, std::move(tours), options, progress);
}

std::vector<std::string> ValidationChains(const Project& project) {
  std::vector<std::string> names;
  for (const ChainSetup& setup : SetupsOfBothSides(project)) names.push_back(setup.name);
  return names;
}

void CheckTries(const Project& project, const MotionTrialOptions& options) {
  if (options.robots == 0 || !project.soles.empty()) return;
  throw InputError(
      project.file.string() +
      ": no section 'standing' with soles on which virtual robots could stand: the root "
      "link is held still, and nothing can fall; plan without a number of robots");
}

std::vector<MotionTrial> TryMotion(const Project& project, const JointMotion& motion,
                                   const MotionTrialOptions& options, const Progress& progress) {
  CheckTries(project, options);
  const DescribedRobot described = DescribeRobot(project);
  const TrueRobot nominal =
      NominalRobot(described.tree, described.markers, FindLegs(described.tree, described.chains),
                   described.torque_sensors);
  std::vector<MotionTrial> trials(Size(options.robots));
  const auto play = [&](std::size_t i) {
    TruthOptions truth;
    truth.seed = options.seed + i;
    truth.leg_geometry_scale = options.leg_errors;
    PhysicsOptions physics;
    physics.floor_friction = options.floor_friction;
    Stabiliser stabiliser(project.tree, project.soles);
    trials[i] = {truth.seed,
                 StandThrough(DrawTrueRobot(nominal, truth), project.soles, motion, physics,
                              {.stabiliser = options.stabilised ? &stabiliser : nullptr})};
  };
  ForAll(trials.size(), options.threads, play, progress);
  return trials;
}

void CountToOwnLimits(const Project& own, const Project& narrow, const MotionPlanOptions& options,
                      MotionPlan& plan) {
  Worst& position = plan.margins.position;
  if (position.index < 0) return;
  const Joint& joint = own.tree.joints[Size(position.index)];
  const JointLimits& left = narrow.tree.joints[Size(position.index)].limits;
  const double room =
      std::min(left.lower - joint.limits.lower, joint.limits.upper - left.upper);  // either end
  if (!(room > 0.0)) return;
  position.value += room;
  const bool slides = joint.type == JointType::kPrismatic;
  const auto text = [&](double distance) {
    return slides ? fmt::format("{:.1f}", 1e3 * distance)
                  : fmt::format("{:.2f}", distance * 180.0 / M_PI);
  };
  for (LimitUse& use : plan.limits) {
    if (!use.what.starts_with("joint to end of range")) continue;
    use.worst = text(position.value);
    use.limit = text(options.limits.position_margin + room);
  }
}

}  // namespace elastocal
