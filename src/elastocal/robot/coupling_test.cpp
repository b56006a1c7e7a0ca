// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/coupling.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/robot/subtree.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// Four joints about y in a row, 0.3 m apart, with masses: lean, bend, level and last, which
/// follows level as a mimic joint. The tip is 0.2 m further.
RobotTree LeaningTorso() {
  RobotTree tree = MakeRoot();
  int link = 0;
  for (const char* name : {"lean", "bend", "level", "last"}) {
    link = AddJoint(tree, name, link, Offset(0.1, 0.05, 0.3), {0, 1, 0});
    tree.links[link].mass = 2.0;
    tree.links[link].com = {0.02, 0.01, 0.15};
  }
  MakeLastJointMimic(tree, 2, 0.5, 0.1);
  AddFixedLink(tree, "tip", link, Offset(0, 0, 0.2));
  return tree;
}

/// Couples level = -(lean + bend) + 0.2.
RobotTree LevelTorso() { return Couple(LeaningTorso(), {{2, {{0, -1.0}, {1, -1.0}}, 0.2}}); }

TEST(Coupling, AJointFollowsTheSumOfTwo) {
  const RobotTree tree = LevelTorso();
  ASSERT_EQ(tree.coordinate_count(), 2);
  EXPECT_TRUE(tree.joints[2].mimic);
  const Eigen::Vector2d q(0.3, -0.7);
  // level = -(0.3 - 0.7) + 0.2, last = 0.5 * level + 0.1.
  EXPECT_NEAR(JointPosition(tree.joints[2], q), 0.6, 1e-15);
  EXPECT_NEAR(JointPosition(tree.joints[3], q), 0.4, 1e-15);
  // The tip turns by lean + bend + level + last.
  const Transform T = LinkTransforms(tree, q)[Size(FindLink(tree, "tip"))];
  EXPECT_LT((T.linear() - RotAxis({0, 1, 0}, 0.6).linear()).norm(), 1e-14);
}

TEST(Coupling, CoupledJointsAndMimicsMayFollowEachOther) {
  // bend = 2 lean + 0.1, level = 3 bend - lean = 5 lean + 0.3, last = 2.5 lean + 0.25.
  const RobotTree tree =
      Couple(LeaningTorso(), {{2, {{1, 3.0}, {0, -1.0}}, 0.0}, {1, {{0, 2.0}}, 0.1}});
  ASSERT_EQ(tree.coordinate_count(), 1);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.4);
  EXPECT_NEAR(JointPosition(tree.joints[2], q), 2.3, 1e-14);
  EXPECT_NEAR(JointPosition(tree.joints[3], q), 1.25, 1e-14);
  // Coupling through the mimic joint: bend = last = 0.5 level + 0.1.
  const RobotTree by_mimic = Couple(LeaningTorso(), {{1, {{3, 1.0}}, 0.0}});
  EXPECT_EQ(by_mimic.joints[1].coordinate, by_mimic.joints[2].coordinate);
  EXPECT_EQ(by_mimic.joints[1].multiplier, 0.5);
  EXPECT_EQ(by_mimic.joints[1].offset, 0.1);
}

TEST(Coupling, SaysWhatCannotBeCoupled) {
  const RobotTree tree = LeaningTorso();
  ExpectInputError([&] { Couple(tree, {{2, {{3, 1.0}}, 0.0}}); }, {"'level'", "itself"});
  ExpectInputError([&] { Couple(tree, {{0, {{1, 1.0}}, 0.0}, {1, {{0, 1.0}}, 0.0}}); }, {"itself"});
  ExpectInputError([&] { Couple(tree, {{3, {{0, 1.0}}, 0.0}}); }, {"'last'", "already"});
  ExpectInputError(
      [&] {
        Couple(tree, {{2, {{0, 1.0}}, 0.0}, {2, {{1, 1.0}}, 0.0}});
      },
      {"'level'", "twice"});
}

TEST(Coupling, DerivativesOfAChainAreThoseOfDifferences) {
  const RobotTree tree = LevelTorso();
  const int tip = FindLink(tree, "tip");
  EXPECT_EQ(ChainCoordinates(tree, 0, tip), (std::vector<int>{0, 1}));
  MovingChain chain(tree, {0, 1}, Eigen::Vector2d::Zero());
  const Eigen::Vector2d x(0.4, -0.9);
  constexpr double kStep = 1e-6;
  const auto potential = [&](const Eigen::Vector2d& q) {
    const auto poses = LinkTransforms(tree, q);
    double energy = 0.0;
    for (std::size_t i = 0; i < tree.links.size(); ++i) {
      energy -= tree.links[i].mass * kGravity.dot(poses[i] * tree.links[i].com);
    }
    return energy;
  };
  chain.Move(x);
  const Eigen::Vector3d p = chain.link_poses()[Size(tip)].translation();
  const Eigen::Matrix3Xd J = chain.PointJacobian(tip, p), R = chain.RotationJacobian(tip);
  const Eigen::VectorXd torques = GravityTorques(tree, x, kGravity);
  for (int c = 0; c < 2; ++c) {
    const Eigen::RowVectorXd curvature = chain.GravityTorqueGradient(c);
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(c);
    const Transform ahead = LinkTransforms(tree, x + step)[Size(tip)];
    const Transform behind = LinkTransforms(tree, x - step)[Size(tip)];
    // With a step of 1e-6, rounding is 1e-10, and truncation is the third derivative times 1e-12.
    EXPECT_LT((J.col(c) - (ahead.translation() - behind.translation()) / (2 * kStep)).norm(), 1e-8);
    const Eigen::AngleAxisd turn((ahead * behind.inverse()).linear());
    EXPECT_LT((R.col(c) - turn.angle() * turn.axis() / (2 * kStep)).norm(), 1e-8);
    const double slope = (potential(x + step) - potential(x - step)) / (2 * kStep);
    EXPECT_NEAR(torques[c], slope, 1e-7);
    EXPECT_NEAR(chain.GravityTorque(c), slope, 1e-7);
    for (int other = 0; other < 2; ++other) {
      const Eigen::Vector2d aside = kStep * Eigen::Vector2d::Unit(other);
      const double change = (GravityTorques(tree, x + aside, kGravity)[c] -
                             GravityTorques(tree, x - aside, kGravity)[c]) /
                            (2 * kStep);
      EXPECT_NEAR(curvature[other], change, 1e-6);
    }
  }
}

TEST(Coupling, APartOfTheRobotKeepsItsCouplings) {
  const RobotTree tree = LevelTorso();
  const RobotTree part = Subtree(tree, FindLink(tree, "bend_link"));
  ASSERT_EQ(part.joints.size(), 2u);
  ASSERT_EQ(part.coordinate_count(), 2);
  // The entries of q have the order in which the part's joints name them: lean, bend.
  EXPECT_NEAR(JointPosition(part.joints[0], Eigen::Vector2d(0.3, -0.7)), 0.6, 1e-15);
  RobotTree copy = LeaningTorso();
  CopyDrives(tree, copy);
  EXPECT_EQ(copy.coordinate_count(), 2);
  EXPECT_EQ(JointPosition(copy.joints[3], Eigen::Vector2d(0.3, -0.7)),
            JointPosition(tree.joints[3], Eigen::Vector2d(0.3, -0.7)));
}

}  // namespace
}  // namespace elastocal
