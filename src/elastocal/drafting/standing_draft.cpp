// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/standing_draft.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// The drafted robot on its feet. Throws InputError if it cannot stand on them.
std::unique_ptr<StandingRobot> StandDraft(const ProjectDraft& draft) {
  std::vector<Sole> soles;
  for (const DraftedSole& sole : draft.soles) {
    soles.push_back({FindLink(draft.tree, sole.link), sole.lower, sole.upper, sole.ball_radius});
  }
  MotionLimits limits;
  limits.torque_share = draft.motion_effort_share;
  auto robot = std::make_unique<StandingRobot>(draft.tree, std::move(soles), limits);
  StandOptions options;
  options.stance = draft.stance;
  StandUp(*robot, draft.rest.q, options);
  return robot;
}

/// As StandDraft, but empty if it cannot stand, for example with the hands ahead; `plan` then tells
/// the reason.
std::unique_ptr<StandingRobot> TryStandDraft(const ProjectDraft& draft) {
  if (!draft.stands) return nullptr;
  try {
    return StandDraft(draft);
  } catch (const InputError&) {
    return nullptr;
  }
}

/// The posture in which the robot stands on all feet with its weight over those that stand while
/// the foot `swings` is lifted (StandingRobot::AllFeetBut); empty if its legs do not reach so far.
std::optional<PlacedPosture> OverFewest(const StandingRobot& robot, int swings) {
  const std::vector<int> fewest =
      robot.soles.size() > 1 ? robot.AllFeetBut(swings) : robot.AllFeet();
  PlacedPosture over{robot.rest, robot.T_world_root};
  if (!BalanceAtRest(robot, robot.AllFeet(), SupportCentre(robot, fewest), over)) {
    return std::nullopt;
  }
  return over;
}

/// The robot lifts a foot once, as `plan` does; without a motion if it cannot.
PlannedTour LiftOnce(const StandingRobot& robot, int foot) {
  PostureTour step;
  step.standing = robot.AllFeetBut(foot);
  step.postures = {robot.rest};
  return PlanTour(robot, step, {});
}

/// Reason why a robot does not stand; `why` is empty if it does.
struct Refused {
  std::string why;
  bool weak = false;  ///< its motors are too weak
};

/// Whether the robot can lift a foot as `plan` does.
Refused LiftRefused(const StandingRobot& robot, int foot) {
  if (robot.soles.size() < 2) return {};
  const PlannedTour planned = LiftOnce(robot, foot);
  if (planned.motion.q.rows() > 0) return {};
  const LeftOut& left_out = planned.left_out.front();
  Refused refused{"it cannot stand without " +
                      Quote(robot.tree.links[Size(robot.soles[Size(foot)].link)].name) + ": " +
                      ConstraintName(left_out.constraint),
                  left_out.constraint == Constraint::kTorque};
  if (refused.weak || left_out.constraint == Constraint::kPosition) {
    refused.why += " of " + Quote(robot.tree.joints[Size(left_out.index)].name);
  }
  if (refused.weak) {
    constexpr double kAbsurd = 3.0;
    refused.why +=
        fmt::format(" ({:.0f} % of its effort, {:.0f} may be used{})", 100.0 * left_out.value,
                    100.0 * robot.limits.torque_share,
                    left_out.value > kAbsurd
                        ? "; is the effort in the URDF that of a motor before its gear, or "
                          "are masses not in kg, or inertias not in kg.m^2?"
                        : "");
  }
  return refused;
}

/// Finds out whether the drafted robot can stand as `plan` requires, with at most this share of its
/// motors' efforts.
Refused StandRefused(const ProjectDraft& draft, double torque_share) {
  if (draft.soles.empty()) return {};
  if (!draft.rest.stands) {
    return {"no posture of rest was found in which the soles are flat on one floor"};
  }
  try {
    const auto robot = StandDraft(draft);
    robot->limits.torque_share = torque_share;
    for (const int foot : robot->AllFeet()) {
      if (Refused refused = LiftRefused(*robot, foot); !refused.why.empty()) return refused;
    }
  } catch (const InputError& error) {
    return {error.what()};
  }
  return {};
}

/// Masses that the robot description lacks and standing needs; empty if it has them.
std::string MissingMasses(const ProjectDraft& draft) {
  const RobotTree& tree = draft.tree;
  if (!HasMasses(tree)) return "the robot description has no masses";
  for (const Limb& limb : draft.limbs.limbs) {
    if (!limb.leg) continue;
    const bool weighs = std::any_of(tree.links.begin(), tree.links.end(), [&](const Link& link) {
      return link.mass > 0.0 &&
             std::find(limb.joints.begin(), limb.joints.end(), link.body - 1) != limb.joints.end();
    });
    if (!weighs) return "the links of limb " + Quote(limb.name) + " have no masses";
  }
  return "";
}

}  // namespace

bool HasMasses(const RobotTree& tree) {
  return std::any_of(tree.links.begin(), tree.links.end(),
                     [](const Link& link) { return link.mass > 0.0; });
}

void RestOnFeet(ProjectDraft& draft, const Semantics& semantics) {
  // Shares by which the root link is lowered if the usual posture fails. A leg that is nearly
  // straight cannot follow the weight; an ankle that bends little, or a weak motor, requires a
  // nearly straight leg. These postures need as little effort as those that will be designed.
  const std::vector<double> less = {0.04, 0.02}, any = {0.10, 0.15, 0.20, 0.25, 0.04, 0.02};
  // Share of the motors' efforts if nothing else helps: the rest is for errors of the masses.
  constexpr double kNearlyAll = 0.97;
  const auto refused_at = [&](double drop, double torque_share) {
    draft.rest = ChooseRest(draft.tree, draft.limbs, draft.soles, semantics, drop);
    return StandRefused(draft, torque_share);
  };
  const auto stands_at = [&](double drop, double torque_share) {
    if (!refused_at(drop, torque_share).why.empty()) return false;
    draft.motion_effort_share = std::max(draft.motion_effort_share, torque_share);
    draft.stands = !draft.soles.empty();
    return true;
  };
  const Refused usual = refused_at(kUsualDrop, draft.motion_effort_share);
  if (usual.why.empty()) {
    draft.stands = !draft.soles.empty();
    return;
  }
  for (const double drop : usual.weak ? less : any) {
    if (stands_at(drop, kDraftedEffort)) return;
  }
  if (usual.weak) {
    for (const double drop : {kUsualDrop, less[0], less[1]}) {
      if (stands_at(drop, kNearlyAll)) return;
    }
  }
  draft.rest = ChooseRest(draft.tree, draft.limbs, draft.soles, semantics, kUsualDrop);
  const std::string missing = MissingMasses(draft);
  draft.held_because = missing.empty() ? usual.why : missing + ", without which nothing stands";
}

void NarrowWaist(ProjectDraft& draft) {
  constexpr int kSteps = 40;
  const auto robot = TryStandDraft(draft);
  if (!robot) return;
  const auto [lower, upper] = RangesOf(draft.tree, 0.05);
  const auto stands = [&, &lower = lower, &upper = upper](int c, double position) {
    PlacedPosture pose{robot->rest, robot->T_world_root};
    pose.q[c] = position;
    if (!BalanceAtRest(*robot, robot->AllFeet(), SupportCentre(*robot, robot->AllFeet()), pose)) {
      return false;
    }
    return std::all_of(robot->legs.begin(), robot->legs.end(), [&](const LegChain& leg) {
      const auto& own = leg.coordinates();
      return (pose.q - lower)(own).minCoeff() >= 0.0 && (upper - pose.q)(own).minCoeff() >= 0.0;
    });
  };
  std::set<int> above;
  for (const Limb& limb : draft.limbs.limbs) {
    if (!limb.leg) continue;
    const auto trunk = ChainCoordinates(draft.tree, 0, BodyLink(draft.tree, limb.from_body));
    above.insert(trunk.begin(), trunk.end());
  }
  for (const int c : above) {
    const double rest = robot->rest[c];
    Eigen::Vector2d range(rest, rest);
    for (const int end : {0, 1}) {
      const double step = ((end == 0 ? lower[c] : upper[c]) - rest) / kSteps;
      for (int i = 1; i <= kSteps && stands(c, rest + i * step); ++i) range[end] = rest + i * step;
    }
    if (range[0] < range[1]) draft.ranges[c] = range;
  }
}

std::vector<Eigen::VectorXd> RestingPostures(const ProjectDraft& draft) {
  std::vector<Eigen::VectorXd> postures = {draft.rest.q};
  const auto robot = TryStandDraft(draft);
  if (!robot) return postures;
  postures.push_back(robot->rest);
  for (const int foot : robot->AllFeet()) {
    if (const auto over = OverFewest(*robot, foot)) postures.push_back(over->q);
    if (robot->soles.size() < 2) continue;
    const SampledMotion lift = LiftOnce(*robot, foot).motion;
    const auto every = std::max<Eigen::Index>(1, std::lround(0.2 * lift.rate_hz));
    for (Eigen::Index i = 0; i < lift.q.rows(); i += every) {
      postures.emplace_back(lift.q.row(i).transpose());
    }
  }
  return postures;
}

}  // namespace elastocal
