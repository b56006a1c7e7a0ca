// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/physical_inertia.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "elastocal/math/transform.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

TEST(PhysicalInertia, LeavesWhatExistsAsItIs) {
  Eigen::Matrix3d inertia = Eigen::Vector3d(0.2, 0.3, 0.5).asDiagonal();  // a flat plate: A + B = C
  EXPECT_EQ(PhysicalInertia(inertia), inertia);
  inertia(0, 1) = inertia(1, 0) = 0.01;
  EXPECT_EQ(PhysicalInertia(inertia), inertia);
}

TEST(PhysicalInertia, RaisesTheSmallerMomentsByHalfOfWhatIsMissing) {
  // Each moment must grow by (5 - 1 - 2) / 2 = 1 to make the two smaller ones reach the largest.
  const Eigen::Matrix3d R = (RotX(0.4) * RotZ(-1.1)).linear();
  const Eigen::Matrix3d turned = R * Eigen::Vector3d(5.0, 1.0, 2.0).asDiagonal() * R.transpose();
  const Eigen::Matrix3d expected = R * Eigen::Vector3d(5.0, 2.0, 3.0).asDiagonal() * R.transpose();
  EXPECT_LT((PhysicalInertia(turned) - expected).norm(), 1e-5);  // a margin of a millionth
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(PhysicalInertia(turned)).eigenvalues();
  EXPECT_GT(moments[0] + moments[1], moments[2]);
}

TEST(PhysicalInertia, NegativeMomentsBecomePhysical) {
  const Eigen::Matrix3d inertia = Eigen::Vector3d(-0.1, 0.2, 0.2).asDiagonal();
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(PhysicalInertia(inertia)).eigenvalues();
  EXPECT_GE(moments[0], 0.0);
  EXPECT_GE(moments[0] + moments[1], moments[2] - 1e-12);
}

TEST(PhysicalInertia, WarningsNameTheLink) {
  RobotTree tree = MakeRoot();
  const int link = AddJoint(tree, "joint", 0, Offset(0, 0, 1), {0, 0, 1});
  EXPECT_EQ(InertiaWarnings(tree).size(), 1U);  // without mass
  tree.links[static_cast<std::size_t>(link)].mass = 1.0;
  EXPECT_EQ(InertiaWarnings(tree).size(), 1U);  // without inertia
  tree.links[static_cast<std::size_t>(link)].inertia = 0.1 * Eigen::Matrix3d::Identity();
  EXPECT_TRUE(InertiaWarnings(tree).empty());
  tree.links[static_cast<std::size_t>(link)].inertia(2, 2) = 0.3;
  ASSERT_EQ(InertiaWarnings(tree).size(), 1U);
  EXPECT_NE(InertiaWarnings(tree)[0].find(tree.links[static_cast<std::size_t>(link)].name),
            std::string::npos);
  tree.links[static_cast<std::size_t>(link)].inertia = 5.0 * Eigen::Matrix3d::Identity();
  ASSERT_EQ(InertiaWarnings(tree).size(), 1U);  // 1 kg, in a robot of 2 m
  EXPECT_NE(InertiaWarnings(tree)[0].find("wider than the robot"), std::string::npos);
}

// Two joints of a shoulder whose axes meet: the upper arm, which the second one moves, has all the
// mass.
TEST(PhysicalInertia, ALinkBetweenTwoJointsNeedsNoMass) {
  RobotTree tree = MakeRoot();
  const int cross = AddJoint(tree, "pitch", 0, Offset(0, 0, 1), {0, 1, 0});
  Link& arm = tree.links[static_cast<std::size_t>(
      AddJoint(tree, "roll", cross, Offset(0, 0, 0), {1, 0, 0}))];
  EXPECT_EQ(InertiaWarnings(tree).size(), 2U);
  arm.mass = 1.0;
  arm.inertia = 0.1 * Eigen::Matrix3d::Identity();
  EXPECT_TRUE(InertiaWarnings(tree).empty());
}

// A massive hand does not hide that the upper arm has no mass.
TEST(PhysicalInertia, ALongLinkNeedsAMass) {
  RobotTree tree = MakeRoot();
  const int arm = AddJoint(tree, "shoulder", 0, Offset(0, 0, 1), {0, 1, 0});
  Link& hand = tree.links[static_cast<std::size_t>(
      AddJoint(tree, "elbow", arm, Offset(0, 0, -0.4), {0, 1, 0}))];
  hand.mass = 1.0;
  hand.inertia = 0.1 * Eigen::Matrix3d::Identity();
  ASSERT_EQ(InertiaWarnings(tree).size(), 1U);
  EXPECT_NE(InertiaWarnings(tree)[0].find(tree.links[static_cast<std::size_t>(arm)].name),
            std::string::npos);
}

TEST(PhysicalInertia, WarnsOfMassesInGrams) {
  RobotTree tree = MakeRoot();
  Link& link =
      tree.links[static_cast<std::size_t>(AddJoint(tree, "joint", 0, Offset(0, 0, 1), {0, 0, 1}))];
  link.mass = 20.0;
  link.inertia = Eigen::Matrix3d::Identity();
  tree.links[0].mass = 20e3;  // a root on the floor may weigh anything
  tree.links[0].inertia = 1e3 * Eigen::Matrix3d::Identity();
  EXPECT_TRUE(InertiaWarnings(tree).empty());
  link.mass = 20e3;
  ASSERT_EQ(InertiaWarnings(tree).size(), 1U);
  EXPECT_EQ(InertiaWarnings(tree)[0],
            "the parts that joints move weigh 20000 kg, in a robot that reaches 1 m: are the "
            "masses of the URDF in kg?");
}

}  // namespace
}  // namespace elastocal
