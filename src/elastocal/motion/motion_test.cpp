// SPDX-License-Identifier: Apache-2.0
// Balanced motions of a small biped: the kinematics of its legs, up to motions through a whole set
// of postures.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/motion/link_zmp.hpp"
#include "elastocal/motion/move_builder.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/motion/sampled_motion.hpp"
#include "tests/walker.hpp"

namespace elastocal {
namespace {

class BalancedWalker : public testing::Test {
 protected:
  BalancedWalker() : walker_(MakeWalker()), robot_(walker_.tree, walker_.soles, {}) {
    StandUp(robot_, NeutralPosture(robot_.tree, 0.05), {});
  }

  Eigen::VectorXd Posture(double yaw, double pitch, double arm) const {
    Eigen::VectorXd q = robot_.rest;
    q.head<3>() << yaw, pitch, arm;
    return q;
  }

  /// A ball in front of the robot, which the hand must avoid.
  void PutBallInTheWay() {
    const int hand = walker_.hand;
    robot_.clearances = [this, hand](const Eigen::VectorXd& q) -> Eigen::VectorXd {
      const Transform T = LinkTransforms(robot_.tree, q)[static_cast<std::size_t>(hand)];
      const Eigen::Vector3d ball(0.45, -0.2, 0.33);
      return Eigen::VectorXd::Constant(1, (T * Eigen::Vector3d(0.4, 0, 0) - ball).norm() - 0.08);
    };
  }

  Walker walker_;
  StandingRobot robot_;
};
using BalancedWalkerStudy = BalancedWalker;

TEST_F(BalancedWalker, PlacesItsFeetWhereItIsTold) {
  Random random(1);
  const LegChain& leg = robot_.legs[0];
  for (int i = 0; i < 50; ++i) {
    Eigen::VectorXd q = robot_.rest;
    for (const int c : leg.coordinates()) q[c] += random.Uniform(-0.3, 0.3);
    const Transform wanted = leg.SolePose(q);
    Eigen::VectorXd found = robot_.rest;
    ASSERT_TRUE(leg.Place(wanted, found));
    // The tolerance is that of the solver, over the least singular value of a bent leg, some 0.1.
    EXPECT_LT((found - q).norm(), 1e-9);
    EXPECT_LT((LinkTransforms(robot_.tree, found)[static_cast<std::size_t>(leg.sole_link())]
                   .translation() -
               wanted.translation())
                  .norm(),
              1e-10);
  }
  Eigen::VectorXd q = robot_.rest;
  EXPECT_FALSE(leg.Place(Offset(0, 0.085, -1.3), q));  // longer than the leg
}

// Because of rounding, 0.35 m - 0.343 m is less than 2 % of 0.35 m.
TEST_F(BalancedWalker, MayStandAtItsMargin) {
  MotionMargins margins = CheckMotion(robot_, {100.0, robot_.rest.transpose(), {robot_.AllFeet()}});
  margins.position.value = robot_.limits.position_margin - 1e-12;
  EXPECT_FALSE(Broken(margins, robot_.limits));
  margins.position.value = robot_.limits.position_margin - 1e-6;
  EXPECT_EQ(Broken(margins, robot_.limits), Constraint::kPosition);
}

TEST_F(BalancedWalker, RestsOverItsFeet) {
  const MotionMargins margins =
      CheckMotion(robot_, {100.0, robot_.rest.transpose(), {robot_.AllFeet()}});
  EXPECT_FALSE(Broken(margins, robot_.limits));
  EXPECT_NEAR(margins.zmp.value, 0.1, 1e-9);  // from the middle of soles that are 0.2 m long
  EXPECT_LT(margins.foot_moved.value, 1e-10);
}

TEST_F(BalancedWalker, KeepsTheZeroMomentPointInFastMotions) {
  // The trunk turns and bends by 0.8 rad in two seconds. With statics alone, the error is
  // centimetres.
  Stretch stretch;
  stretch.standing = robot_.AllFeet();
  stretch.begin = {robot_.rest, robot_.T_world_root};
  stretch.end = {Posture(0.8, 0.8, -0.5), robot_.T_world_root};
  ASSERT_TRUE(BalanceAtRest(robot_, stretch.standing, SupportCentre(robot_, stretch.standing),
                            stretch.end));
  JointPathOptions options;
  options.duration_s = 2.0;
  const Eigen::MatrixXd way = SamplePath(
      PlanJointPath(robot_, robot_.clearances, robot_.rest, stretch.end.q, {0, 1, 2}, options),
      100.0);
  stretch.q.resize(way.rows() + 100, way.cols());
  stretch.q << way.row(0).replicate(50, 1), way, way.bottomRows(1).replicate(50, 1);
  stretch.zmp = SupportCentre(robot_, stretch.standing).transpose().replicate(stretch.q.rows(), 1);
  const auto largest = [&](int passes) {
    BalanceOptions balance;
    balance.passes = passes;
    balance.velocity_weight = 0.0;
    const BalancedStretch found = Balance(robot_, stretch, balance);
    EXPECT_TRUE(found.in_reach);
    return (found.zmp - stretch.zmp).rowwise().norm().maxCoeff();
  };
  EXPECT_GT(largest(0), 0.03);
  // Each pass reduces the error. At the ends, where the root link stands still, some millimetres
  // remain.
  EXPECT_LT(largest(6), 0.004);

  const BalancedStretch found = Balance(robot_, stretch, {});
  SampledMotion motion{100.0, found.q, {}};
  motion.standing.assign(static_cast<std::size_t>(found.q.rows()), stretch.standing);
  MotionForces forces;
  const MotionMargins margins = CheckMotion(robot_, motion, &forces);
  EXPECT_LT(margins.foot_moved.value, 1e-9);
  EXPECT_LT(margins.foot_turned.value, 1e-9);
  // The check computes the root link's pose and the zero-moment point in another way than the
  // planner.
  EXPECT_LT((forces.zmp - found.zmp).cwiseAbs().maxCoeff(), 1e-6);
}

// Inverse dynamics use the joints. The poses of the links alone must give the same.
TEST_F(BalancedWalker, ZeroMomentPointOfLinksIsThatOfTheJoints) {
  constexpr int kSamples = 201;
  SampledMotion motion{100.0, robot_.rest.transpose().replicate(kSamples, 1), {}};
  motion.standing.assign(kSamples, robot_.AllFeet());
  for (int i = 0; i < kSamples; ++i) {
    const double sway = std::pow(std::sin(M_PI / 100.0 * i), 2);
    motion.q.row(i).head<3>() += sway * Eigen::RowVector3d(0.2, 0.1, 0.5);
  }
  MotionForces forces;
  CheckMotion(robot_, motion, &forces);
  LinkZmp follow(robot_.tree, 0.01);
  for (int i = 0; i <= kSamples; ++i) {
    std::optional<Eigen::Vector2d> zmp;
    if (i == kSamples) {
      zmp = follow.Last();
    } else {
      std::vector<Transform> T = LinkTransforms(robot_.tree, motion.q.row(i).transpose());
      for (Transform& one : T) one = forces.T_world_root[static_cast<std::size_t>(i)] * one;
      zmp = follow.Next(T);
    }
    ASSERT_EQ(zmp.has_value(), i > 0);
    if (zmp) {
      EXPECT_NEAR((zmp->transpose() - forces.zmp.row(i - 1)).norm(), 0.0, 3e-4) << i;
    }
  }
  EXPECT_GT((forces.zmp.rowwise() - forces.zmp.row(0)).rowwise().norm().maxCoeff(), 5e-3);
}

TEST_F(BalancedWalker, AverageZeroMomentPointsKeepWhatLastsAndNotASample) {
  constexpr int kSamples = 200;
  const std::vector<std::vector<int>> standing(kSamples, robot_.AllFeet());
  const Eigen::RowVector2d middle = SupportCentre(robot_, robot_.AllFeet()).transpose();
  Eigen::MatrixX2d zmp = middle.replicate(kSamples, 1);
  const auto least = [&] { return LeastAverageZmp(robot_, standing, zmp, 0.01); };
  EXPECT_NEAR(least().value, 0.1, 1e-9);
  zmp(100, 0) += 0.15;
  EXPECT_GT(least().value, 0.09);
  zmp.col(0).segment(100, 50).setConstant(middle.x() + 0.15);
  EXPECT_NEAR(least().value, -0.05, 1e-9);
  EXPECT_GE(least().sample, 100);
}

TEST_F(BalancedWalker, VisitsPosturesOnOneFoot) {
  PostureTour set{.name = "left", .standing = {1}, .postures = {}};
  for (const double hip : {-0.7, -0.4, -1.0}) {
    Eigen::VectorXd q = Posture(0.3 * hip, 0.1, 0.2);
    q[robot_.legs[0].coordinates()[2]] = hip;
    q[robot_.legs[0].coordinates()[3]] = 1.2;
    set.postures.push_back(q);
  }
  const PlannedTour planned = PlanTour(robot_, set, {});
  ASSERT_TRUE(planned.left_out.empty());
  ASSERT_EQ(planned.visits.size(), 3u);
  const MotionMargins margins = CheckMotion(robot_, planned.motion);
  EXPECT_FALSE(Broken(margins, robot_.limits));
  // The motion begins and ends at rest on both feet.
  EXPECT_LT((planned.motion.q.row(0).transpose() - robot_.rest).norm(), 1e-9);
  EXPECT_LT((planned.motion.q.bottomRows(1).transpose() - robot_.rest).norm(), 1e-9);
  // Accelerations are bounded, so that there is no jump where stretches meet.
  EXPECT_LT(margins.acceleration.value, 5.0);
  for (const Visit& visit : planned.visits) {
    const Eigen::VectorXd& wanted = set.postures[static_cast<std::size_t>(visit.posture)];
    const auto held = planned.motion.q.middleRows(visit.begin, visit.end - visit.begin);
    EXPECT_GE(visit.end - visit.begin, 100);
    for (const int c : robot_.legs[0].coordinates()) {
      EXPECT_LT((held.col(c).array() - wanted[c]).abs().maxCoeff(), 1e-9);
    }
  }
}

// The waist must not lean to move parts away from each other: the lifted foot would be elsewhere,
// and the motion would jump there.
TEST_F(BalancedWalker, LiftsAFootToWhereItIsTold) {
  const PlanOptions options = SizedOptions(robot_, {});
  const MoveBuilder build(robot_, options);
  const Transform wanted = Eigen::Translation3d(0.0, 0.0, 0.05) * robot_.T_world_sole[1];
  const PlacedPosture near{robot_.rest, robot_.T_world_root};
  Refusal why;
  const auto alone = build.AtRestWithFoot({0}, 1, wanted, near, why);
  ASSERT_TRUE(alone);
  robot_.clearances = [&](const Eigen::VectorXd& q) -> Eigen::VectorXd {
    const double leans = (q - alone->q).norm();
    return Eigen::VectorXd::Constant(1, robot_.limits.clearance + 1e-3 + 0.1 * leans);
  };
  const auto up = build.AtRestWithFoot({0}, 1, wanted, near, why);
  ASSERT_TRUE(up);
  const Transform found = up->T_world_root * robot_.legs[1].SolePose(up->q);
  EXPECT_LT((found.matrix() - wanted.matrix()).norm(), 1e-9);
}

TEST_F(BalancedWalker, WithoutBalanceTheZeroMomentPointLeavesTheFoot) {
  PostureTour set{.name = "left", .standing = {1}, .postures = {robot_.rest}};
  PlanOptions options;
  options.balanced = false;
  const MotionMargins margins = CheckMotion(robot_, PlanTour(robot_, set, options).motion);
  EXPECT_LT(margins.zmp.value, -0.01);
}

TEST_F(BalancedWalker, GoesAroundWhatIsInTheWay) {
  PutBallInTheWay();
  const Eigen::VectorXd from = Posture(0, 0, -1.0), to = Posture(0, 0, 1.0);
  const JointPath blind = PlanJointPath(robot_, robot_.clearances, from, to, {2}, {});
  EXPECT_LT(blind.clearance, 0.0);  // with one joint there is no way around
  const JointPath path = PlanJointPath(robot_, robot_.clearances, from, to, {0, 1, 2}, {});
  EXPECT_GE(path.clearance, JointPathOptions{}.clearance);
  const Eigen::MatrixXd way = SamplePath(path, 100.0);
  for (Eigen::Index i = 0; i < way.rows(); ++i) {
    EXPECT_GT(robot_.clearances(way.row(i).transpose())[0], 0.01);
  }
}

// A wall in joint space with a door at one end, which no push along the gradient finds.
TEST_F(BalancedWalker, GoesThroughADoorFarFromTheStraightWay) {
  double door = 0.9;
  robot_.clearances = [&](const Eigen::VectorXd& q) -> Eigen::VectorXd {
    const double wall = std::abs(q[2]) - 0.2;
    return Eigen::VectorXd::Constant(1, 0.1 * std::max(wall, q[1] - door));
  };
  Eigen::VectorXd from = Posture(0, 0, -1.0), to = Posture(0, 0.01, 1.0);
  const JointPath path = PlanJointPath(robot_, robot_.clearances, from, to, {1, 2}, {});
  EXPECT_GE(path.clearance, JointPathOptions{}.clearance);
  const Eigen::MatrixXd way = SamplePath(path, 100.0);
  EXPECT_EQ(way.row(0).transpose(), from);
  EXPECT_EQ(way.bottomRows<1>().transpose(), to);
  for (Eigen::Index i = 0; i < way.rows(); ++i) {
    EXPECT_GT(robot_.clearances(way.row(i).transpose())[0], 0.01);
  }
  door = 10.0;  // without a door, the planner pushes the path
  EXPECT_LT(PlanJointPath(robot_, robot_.clearances, from, to, {1, 2}, {}).clearance, 0.0);
}

TEST_F(BalancedWalker, LeavesOutWhatItCannotDoAndSaysWhy) {
  PostureTour set{.name = "left", .standing = {1}, .postures = {}};
  Eigen::VectorXd far = robot_.rest;
  far[0] = 1.3;  // beyond the limit of the trunk
  set.postures = {Posture(0.5, 0, 0), far};
  const PlannedTour planned = PlanTour(robot_, set, {});
  ASSERT_EQ(planned.left_out.size(), 1u);
  EXPECT_EQ(planned.left_out[0].posture, 1);
  EXPECT_EQ(planned.left_out[0].constraint, Constraint::kPosition);
  EXPECT_EQ(planned.left_out[0].index, 0);
  EXPECT_TRUE(planned.left_out[0].at_rest);
  EXPECT_EQ(planned.visits.size(), 1u);

  robot_.limits.torque_share = 0.05;  // no posture is possible
  const PlannedTour none = PlanTour(robot_, set, {});
  EXPECT_EQ(none.left_out.size(), 2u);
  EXPECT_EQ(none.left_out[0].constraint, Constraint::kTorque);
  EXPECT_EQ(none.motion.q.rows(), 0);
}

TEST_F(BalancedWalker, SwingsJointsToAndFro) {
  PostureTour set{.name = "trunk", .standing = {0, 1}, .postures = {}};
  set.sines = {0, 1, 2};
  const PlannedTour planned = PlanTour(robot_, set, {});
  EXPECT_TRUE(planned.left_out.empty());
  EXPECT_FALSE(Broken(CheckMotion(robot_, planned.motion), robot_.limits));
  for (const int c : set.sines) {
    const auto column = planned.motion.q.col(c);
    EXPECT_GT(column.maxCoeff() - column.minCoeff(), 0.5);
  }
}

// A robot that is not calibrated has its feet lower than it knows, and would stumble.
TEST_F(BalancedWalker, SwingsALiftedLegWellAboveTheFloor) {
  PostureTour set{.name = "leg", .standing = {0}, .postures = {}};
  set.sines = robot_.legs[1].coordinates();
  for (const double swing : {-0.5, 0.5}) {  // the foot is lowest on the way from one to the other
    set.postures.push_back(robot_.rest);
    set.postures.back()[set.sines[2]] += swing;
  }
  const PlannedTour planned = PlanTour(robot_, set, {});
  EXPECT_TRUE(planned.left_out.empty());
  std::vector<double> heights;
  for (Eigen::Index i = 0; i < planned.motion.q.rows(); ++i) {
    const Eigen::VectorXd q = planned.motion.q.row(i).transpose();
    const auto lowest = HeightsOverFloor(robot_.soles[1],
                                         RootOverFeet(robot_, {0}, q) * robot_.legs[1].SolePose(q));
    heights.push_back(*std::min_element(lowest.begin(), lowest.end()));
  }
  const double least = 0.025 * robot_.leg_length;
  const auto high = [&](double height) { return height > least; };
  const auto lifted = std::find_if(heights.begin(), heights.end(), high);
  const auto landing = std::find_if(heights.rbegin(), heights.rend(), high).base();
  ASSERT_GT(landing - lifted, 6 * 300);  // samples of the sines
  EXPECT_GT(*std::min_element(lifted, landing), 0.98 * least);
}

TEST(SinesOfAMotion, AreFiniteForAJointWithoutLimits) {
  Walker walker = MakeWalker();
  const double infinity = std::numeric_limits<double>::infinity();
  walker.tree.joints[0].limits.lower = -infinity;
  walker.tree.joints[0].limits.upper = infinity;
  StandingRobot robot(walker.tree, {}, {});
  StandUp(robot, NeutralPosture(walker.tree, 0.1), {});
  PostureTour set{.name = "held", .standing = {}, .postures = {}};
  set.sines = {0};
  const PlannedTour planned = PlanTour(robot, set, {});
  EXPECT_TRUE(planned.left_out.empty());
  ASSERT_GT(planned.motion.q.rows(), 0);
  EXPECT_TRUE(planned.motion.q.allFinite());
  EXPECT_GT(planned.motion.q.col(0).maxCoeff(), 0.3);
}

TEST_F(BalancedWalkerStudy, ThreadsDoNotMatter) {
  std::vector<PostureTour> sets;
  for (const int foot : {0, 1}) {
    sets.push_back({.name = "set", .standing = {foot}, .postures = {Posture(0.2, 0.1, 0.4)}});
  }
  const auto one = PlanTours(robot_, sets, {}, 1);
  const auto two = PlanTours(robot_, sets, {}, 2);
  const SampledMotion first = JoinMotions(robot_, one, 1.0, 100.0);
  const SampledMotion second = JoinMotions(robot_, two, 1.0, 100.0);
  EXPECT_EQ(first.q, second.q);
  EXPECT_EQ(first.standing, second.standing);
  EXPECT_FALSE(Broken(CheckMotion(robot_, first), robot_.limits));
}

}  // namespace
}  // namespace elastocal
