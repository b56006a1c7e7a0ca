// SPDX-License-Identifier: Apache-2.0
// Gentle starts and ends of corrections at run time.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "elastocal/runtime/core_ease.h"
#include "tests/planar_chain.hpp"
#include "tests/runtime_fixture.hpp"

namespace elastocal {
namespace {

constexpr double kSpeed = 0.03;  // rad a call for each joint: 3 rad/s at 100 calls a second
constexpr double kCalls = 3.0;
constexpr double kMostChange = EC_GENTLE * kSpeed / kCalls;  // largest change of the pace

struct Eased {
  double change_of_pace = 0.0;  ///< largest of a correction between calls
  double change = 0.0;          ///< largest of a command
  std::vector<double> residual_m;
  Eigen::VectorXd last;
  unsigned status = 0;
};

Eased PlayEased(Compensator& robot, const std::vector<Eigen::VectorXd>& plans, double calls,
                StandingFeet feet = 0) {
  robot.Forget();
  robot.EaseChanges(calls);
  Eased played;
  Eigen::VectorXd correction, pace;
  for (std::size_t i = 0; i < plans.size(); ++i) {
    played.status |= robot.Command(plans[i], kNoTorque, feet);
    const Eigen::VectorXd now = robot.command() - plans[i];
    if (i > 0) {
      const Eigen::VectorXd next = now - correction;
      if (i > 1) {
        played.change_of_pace =
            std::max(played.change_of_pace, (next - pace).cwiseAbs().maxCoeff());
      }
      pace = next;
      played.change =
          std::max(played.change, (robot.command() - played.last).cwiseAbs().maxCoeff());
    }
    correction = now;
    played.last = robot.command();
    played.residual_m.push_back(robot.residual_m());
  }
  return played;
}

/// A knee that follows half a period of a cosine. The plan's accelerations have no steps.
std::vector<Eigen::VectorXd> SmoothKnee(double from, double to, int count) {
  std::vector<Eigen::VectorXd> plans;
  for (int i = 0; i <= count; ++i) {
    const double share = 0.5 - 0.5 * std::cos(M_PI * i / count);
    plans.emplace_back(Eigen::Vector3d(0.3, from + share * (to - from), -0.2));
  }
  for (int i = 0; i < 200; ++i) plans.push_back(plans.back());
  return plans;
}

double LargestOf(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

// The leg is 4 mm too short. While the plan's leg is stretched, the best knee angle is 0, which it
// joins and leaves within one call.
TEST(RuntimeEasing, ThroughTheStretchedPostureAccelerationsAreBounded) {
  Compensator robot = PlanarLeg(-4e-3, -2.3, 2.3).Make();
  robot.LimitChanges(Eigen::Vector3d::Constant(kSpeed));
  for (double to : {0.02, 0.1, -0.5}) {
    const std::vector<Eigen::VectorXd> plans = SmoothKnee(0.5, to, 300);
    const Eased at_once = PlayEased(robot, plans, 0.0);
    const Eased eased = PlayEased(robot, plans, kCalls);
    EXPECT_GT(at_once.change_of_pace, 2.5 * kMostChange) << to;
    EXPECT_LE(eased.change_of_pace, kMostChange + 1e-12) << to;
    EXPECT_LE(eased.change, kSpeed + 1e-12);
    // The final command is the same. On the way, the residual is little more than that of a leg
    // that is too short.
    EXPECT_LT((eased.last - at_once.last).cwiseAbs().maxCoeff(), 1e-3) << to;
    EXPECT_NEAR(eased.residual_m.back(), at_once.residual_m.back(), 2e-5) << to;
    EXPECT_LT(LargestOf(eased.residual_m), LargestOf(at_once.residual_m) + 1e-3) << to;
  }
}

// The residual counts both what the search leaves and what the gentle command leaves. It is that of
// the robot.
TEST(RuntimeEasing, TheResidualIsThatOfTheCommandThatIsGiven) {
  Compensator robot = PlanarLeg(-4e-3, -2.3, 2.3).Make(), real = PlanarLeg(-4e-3, -2.3, 2.3).Make();
  Compensator nominal = PlanarLeg(0.0, -2.3, 2.3).Make();
  robot.LimitChanges(Eigen::Vector3d::Constant(kSpeed));
  robot.EaseChanges(kCalls);
  int said = 0;
  for (const Eigen::VectorXd& plan : SmoothKnee(0.5, -0.5, 300)) {
    const unsigned status = robot.Command(plan, kNoTorque, 0);
    real.Forward(robot.command(), kNoTorque, 0);
    nominal.Forward(plan, kNoTorque, 0);
    const double left =
        (real.link_pose(0).translation() - nominal.link_pose(0).translation()).norm();
    EXPECT_NEAR(robot.residual_m(), left, 1e-12);
    const std::vector<unsigned> stopped = robot.stopped();
    const bool held = std::count(stopped.begin(), stopped.end(), unsigned{EC_CORRECTION_CUT}) > 0;
    EXPECT_EQ(held, (status & EC_CORRECTION_CUT) != 0);
    said += held ? 1 : 0;
  }
  EXPECT_GT(said, 0);
}

// If the best command is gentle by itself, the given command has the same bits.
TEST(RuntimeEasing, AGentleCommandIsTheBest) {
  Compensator robot = PlanarLeg(4e-3, -2.3, 2.3).Make(), free = PlanarLeg(4e-3, -2.3, 2.3).Make();
  robot.LimitChanges(Eigen::Vector3d::Constant(kSpeed));
  free.LimitChanges(Eigen::Vector3d::Constant(kSpeed));
  robot.EaseChanges(kCalls);
  for (const Eigen::VectorXd& plan : SmoothKnee(1.2, 0.6, 100)) {
    robot.Command(plan, kNoTorque, 0);
    free.Command(plan, kNoTorque, 0);
    EXPECT_TRUE(robot.command() == free.command());
  }
  // Without a limit of speed, easing changes nothing.
  Compensator unlimited = PlanarLeg(-4e-3, -2.3, 2.3).Make();
  const std::vector<Eigen::VectorXd> plans = SmoothKnee(0.5, 0.02, 100);
  const Eased at_once = PlayEased(unlimited, plans, 0.0);
  EXPECT_EQ(PlayEased(unlimited, plans, kCalls).last, at_once.last);
  EXPECT_EQ(PlayEased(unlimited, plans, -1.0).last, at_once.last);
  EXPECT_EQ(PlayEased(unlimited, plans, std::nan("")).last, at_once.last);
}

// Plans that jump, go beyond limits and pass stretched postures. Limits have priority, even if one
// call must end an approach at full pace.
TEST(RuntimeEasing, LimitsAreKept) {
  Random random(4);
  for (int run = 0; run < 40; ++run) {
    PlanarChain leg = PlanarLeg(random.Uniform(-6e-3, 6e-3), -0.05, 0.6);
    leg.upper[2] = 0.05;
    Compensator robot = leg.Make();
    robot.LimitChanges(Eigen::Vector3d::Constant(kSpeed));
    robot.EaseChanges(kCalls);
    Eigen::Vector3d plan(0.3, 0.3, -0.2), change = Eigen::Vector3d::Zero(), last;
    for (int i = 0; i < 300; ++i) {
      if (i % 15 == 0) {
        for (double& value : change) value = random.Uniform(-0.02, 0.02);
      }
      const Eigen::Vector3d before = plan;
      for (Eigen::Index c = 0; c < 3; ++c) {
        const auto at = static_cast<std::size_t>(c);
        plan[c] = std::clamp(plan[c] + change[c], leg.lower[at], leg.upper[at]);
      }
      robot.Command(plan, kNoTorque, 0);
      for (Eigen::Index c = 0; c < 3; ++c) {
        const auto at = static_cast<std::size_t>(c);
        EXPECT_GE(robot.command()[c], leg.lower[at]);
        EXPECT_LE(robot.command()[c], leg.upper[at]);
        EXPECT_LE(std::abs(robot.command()[c] - plan[c]), 0.25 + 1e-12);
        if (i == 0) continue;
        EXPECT_LE(std::abs(robot.command()[c] - last[c]),
                  std::max(kSpeed, std::abs(plan[c] - before[c])) + 1e-12);
      }
      last = robot.command();
    }
  }
}

class RuntimeEasingTalos : public Runtime {};

// As in RuntimeFollowingTalos, with 100 calls a second.
TEST_F(RuntimeEasingTalos, ANearlyStretchedArmMovesGently) {
  Compensator robot = Make();
  const std::vector<Eigen::VectorXd> plans = StretchOfElbow(300);
  robot.LimitChanges(Eigen::VectorXd::Constant(project_.motion.rest.size(), kSpeed));
  const Eased at_once = PlayEased(robot, plans, 0.0, 1);
  const Eased eased = PlayEased(robot, plans, kCalls, 1);
  EXPECT_GT(at_once.change_of_pace, 3.0 * kMostChange);
  EXPECT_LE(eased.change_of_pace, kMostChange + 1e-12);
  EXPECT_LT(LargestOf(eased.residual_m), LargestOf(at_once.residual_m) + 1e-3);
  EXPECT_LT(eased.residual_m.back(), 2e-5);
}

// Lifting a foot changes the loads at once, and with them the legs. Commands go on from the one
// that was given, not from the best one that it follows: a redundant arm, which lags by 10 mrad,
// keeps its correction.
TEST_F(RuntimeEasingTalos, AStepOfTheSupportIsCorrectedAtOnce) {
  Compensator robot = Make(), free = Make();
  robot.LimitChanges(Eigen::VectorXd::Constant(project_.motion.rest.size(), kSpeed));
  free.LimitChanges(Eigen::VectorXd::Constant(project_.motion.rest.size(), kSpeed));
  robot.EaseChanges(1000.0);
  for (StandingFeet feet : {3U, 1U, 2U}) {
    robot.Command(project_.motion.rest, kNoTorque, feet);
    free.Command(project_.motion.rest, kNoTorque, feet);
    EXPECT_TRUE(robot.command() == free.command()) << feet;
  }
  robot.EaseChanges(30.0);
  Eigen::VectorXd plan = project_.motion.rest;
  for (int i = 0; i < 60; ++i) {
    plan.array() += 1e-3;
    robot.Command(plan, kNoTorque, 3U);
    free.Command(plan, kNoTorque, 3U);
  }
  EXPECT_GT((robot.command() - free.command()).cwiseAbs().maxCoeff(), 5e-3);
  for (int i = 0; i < 40; ++i) {
    const Eigen::VectorXd last = robot.command();
    robot.Command(plan, kNoTorque, 1U);
    free.Command(plan, kNoTorque, 1U);
    EXPECT_LE((robot.command() - last).cwiseAbs().maxCoeff(), EC_GENTLE * kSpeed + 1e-12) << i;
    EXPECT_LT(robot.residual_m(), 2e-5) << i;
    EXPECT_LT(free.residual_m(), 2e-5) << i;
  }
}

// The robot steps from foot to foot while its arm is too short. The loads of the legs jump.
TEST_F(RuntimeEasingTalos, LimitsAreKeptWhereTheSupportChanges) {
  constexpr double kSlow = 1e-3;
  Compensator robot = Make();
  robot.LimitChanges(Eigen::VectorXd::Constant(project_.motion.rest.size(), kSlow));
  const std::vector<Eigen::VectorXd> plans = StretchOfElbow(300);
  for (const double calls : {0.0, 30.0}) {
    robot.EaseChanges(calls);
    robot.Forget();
    Eigen::VectorXd last;
    for (std::size_t i = 0; i < plans.size(); ++i) {
      robot.Command(plans[i], kNoTorque, i / 20 % 3 + 1);
      for (Eigen::Index c = 0; i > 0 && c < last.size(); ++c) {
        const double planned = std::abs(plans[i][c] - plans[i - 1][c]);
        EXPECT_LE(std::abs(robot.command()[c] - last[c]), std::max(kSlow, planned) + 1e-12)
            << i << ", " << c;
      }
      last = robot.command();
    }
  }
}

}  // namespace
}  // namespace elastocal
