// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/standing_draft.hpp"

#include <algorithm>
#include <memory>
#include <set>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// The robot of the draft on its feet. Throws InputError if it cannot stand on them.
std::unique_ptr<StandingRobot> StandDraft(const ProjectDraft& draft) {
  std::vector<Sole> soles;
  for (const DraftedSole& sole : draft.soles) {
    soles.push_back({FindLink(draft.tree, sole.link), sole.lower, sole.upper, sole.ball_radius});
  }
  auto robot = std::make_unique<StandingRobot>(draft.tree, std::move(soles), MotionLimits{});
  StandOptions options;
  options.stance = draft.stance;
  StandUp(*robot, draft.rest.q, options);
  return robot;
}

/// The same; nothing if it cannot stand: with the hands ahead, `plan` will say why.
std::unique_ptr<StandingRobot> TryStandDraft(const ProjectDraft& draft) {
  if (!draft.stands) return nullptr;
  try {
    return StandDraft(draft);
  } catch (const InputError&) {
    return nullptr;
  }
}

/// The posture in which the robot stands on all feet with the weight over the fewest, without
/// `swings`; nothing if its legs do not reach so far.
std::optional<PlacedPosture> OverFewest(const StandingRobot& robot, int swings) {
  const std::vector<int> fewest =
      robot.soles.size() > 1 ? robot.AllFeetBut(swings) : robot.AllFeet();
  PlacedPosture over{robot.rest, robot.T_world_root};
  if (!BalanceAtRest(robot, robot.AllFeet(), SupportCentre(robot, fewest), over)) {
    return std::nullopt;
  }
  return over;
}

/// Why the robot cannot lift a foot as `plan` does; empty if it can.
std::string WhyNotLifted(const StandingRobot& robot, int foot) {
  if (robot.soles.size() < 2) return "";
  PostureTour step;
  step.standing = robot.AllFeetBut(foot);
  step.postures = {robot.rest};
  const PlannedTour planned = PlanTour(robot, step, {});
  if (planned.motion.q.rows() > 0) return "";
  const LeftOut& why = planned.left_out.front();
  std::string text = "it cannot stand without " +
                     Quote(robot.tree.links[Size(robot.soles[Size(foot)].link)].name) + ": " +
                     ConstraintName(why.constraint);
  const bool of_joint =
      why.constraint == Constraint::kPosition || why.constraint == Constraint::kTorque;
  if (of_joint) text += " of " + Quote(robot.tree.joints[Size(why.index)].name);
  return text;
}

}  // namespace

std::string WhyHeld(const ProjectDraft& draft) {
  if (draft.soles.empty()) return "";
  if (!draft.rest.stands) {
    return "no posture of rest was found in which the soles are flat on one floor";
  }
  try {
    const auto robot = StandDraft(draft);
    for (const int foot : robot->AllFeet()) {
      if (std::string why = WhyNotLifted(*robot, foot); !why.empty()) return why;
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
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
  }
  return postures;
}

}  // namespace elastocal
