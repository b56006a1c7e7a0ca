// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/leg_chain.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// A leg whose hip is 0.1 m to the left, with a joint for each letter: the axis that it turns
/// about, or "t" for one about the thigh. Its last link is the sole.
RobotTree OneLeg(const std::string& axes) {
  RobotTree tree = MakeRoot();
  int link = 0, pitches = 0;
  for (const char axis : axes) {
    const bool pitch = axis == 'y';
    // Thigh and shank are 0.4 m long. A joint that turns the thigh is in its middle.
    const bool turned = axes.find('t') != std::string::npos;
    const double down = axis == 't' || (pitch && pitches == 1 && turned) ? -0.2
                        : pitch && pitches > 0                           ? -0.4
                                                                         : 0.0;
    const Eigen::Vector3d direction(axis == 'x', pitch, axis == 'z' || axis == 't');
    link = AddJoint(tree, "leg_" + std::to_string(tree.joints.size() + 1), link,
                    Offset(0, link == 0 ? 0.1 : 0.0, down), direction);
    pitches += pitch ? 1 : 0;
  }
  AddFixedLink(tree, "sole", link, Offset(0, 0, -0.1));
  return tree;
}

constexpr double kHip = -0.5, kKnee = 1.0;

TEST(LegChain, OfSevenJointsStaysNearWhereItIsPlacedFrom) {
  const RobotTree tree = OneLeg("zxytyyx");
  const LegChain leg(tree, {FindLink(tree, "sole")});
  ASSERT_EQ(leg.coordinates().size(), 7u);
  Eigen::VectorXd rest(7);
  rest << 0, 0, kHip, 0, kKnee, kHip, 0;
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd q = rest + random.NormalVector(7, 0.05);
    Eigen::VectorXd found = rest;
    ASSERT_TRUE(leg.Place(leg.SolePose(q), found));
    const Transform off = leg.SolePose(found).inverse() * leg.SolePose(q);
    EXPECT_LT(off.translation().norm() + RotationAngle(off.linear()), 1e-10);
    // Of all postures with this pose of the sole, this is the nearest, apart from the curvature
    // over a step of 0.1 rad.
    EXPECT_LT((found - rest).norm(), 1.05 * (q - rest).norm());
  }
}

TEST(LegChain, OfSevenJointsWithAPreferenceGoesByThePoseAlone) {
  const RobotTree tree = OneLeg("zxytyyx");
  LegChain leg(tree, {FindLink(tree, "sole")});
  Eigen::VectorXd rest(7);
  rest << 0, 0, kHip, 0, kKnee, kHip, 0;
  leg.Prefer(rest);
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Transform wanted = leg.SolePose(rest + random.NormalVector(7, 0.05));
    Eigen::VectorXd one = rest + random.NormalVector(7, 0.1);
    Eigen::VectorXd other = rest + random.NormalVector(7, 0.1);
    ASSERT_TRUE(leg.Place(wanted, one) && leg.Place(wanted, other));
    EXPECT_LT((one - other).norm(), 1e-9);
    EXPECT_LT((leg.SolePose(one).matrix() - wanted.matrix()).norm(), 1e-10);
  }
}

/// A leg of five joints with a bent knee, and a place for its sole nearby.
class FiveJointLeg : public testing::Test {
 protected:
  FiveJointLeg() : tree_(OneLeg("xyyyx")), leg_(tree_, {FindLink(tree_, "sole")}), q_(5) {
    q_ << 0, kHip, kKnee, kHip, 0;
    wanted_ = leg_.SolePose(q_);
    wanted_.translation() += Eigen::Vector3d(0.03, -0.05, 0.02);
  }

  const RobotTree tree_;
  const LegChain leg_;
  Eigen::VectorXd q_;
  Transform wanted_;
};

TEST_F(FiveJointLeg, ReachesWhatIsParallelToTheRoot) {
  ASSERT_TRUE(leg_.Place(wanted_, q_));
  EXPECT_LT((leg_.SolePose(q_).matrix() - wanted_.matrix()).norm(), 1e-10);
  wanted_.linear() = RotAxis({0, 0, 1}, 0.2).linear();
  EXPECT_FALSE(leg_.Place(wanted_, q_));
}

TEST_F(FiveJointLeg, PutsItsSoleFlatWhateverItsHeading) {
  wanted_.linear() = (RotAxis({0, 0, 1}, 0.2) * RotAxis({0.6, 0.8, 0}, 0.1)).linear();
  ASSERT_TRUE(leg_.PlaceFlat(wanted_, q_));
  const Transform found = leg_.SolePose(q_);
  EXPECT_LT((found.translation() - wanted_.translation()).norm(), 1e-10);
  EXPECT_LT((found.linear().col(2) - wanted_.linear().col(2)).norm(), 1e-10);
}

TEST(LegChain, JointsOfALegMayFollowEachOther) {
  // The second knee always bends like the first.
  RobotTree tree = OneLeg("zxyyyyx");
  for (const std::size_t k : {4u, 5u, 6u}) tree.joints[k].coordinate -= 1;
  tree.joints[4].mimic = true;
  tree.coordinate_joint = {0, 1, 2, 3, 5, 6};
  const LegChain leg(tree, {FindLink(tree, "sole")});
  Eigen::VectorXd q(6);
  q << 0, 0, -0.6, 0.6, -0.6, 0;
  Transform wanted = leg.SolePose(q);
  wanted.translation() += Eigen::Vector3d(0.03, -0.05, 0.02);
  ASSERT_TRUE(leg.Place(wanted, q));
  EXPECT_LT((leg.SolePose(q).matrix() - wanted.matrix()).norm(), 1e-10);

  const RobotTree four = OneLeg("xyyy");
  ExpectInputError([&] { LegChain(four, {FindLink(four, "sole")}); }, {"4 joints"});
}

TEST(LegChain, AJointThatOthersShareStaysAndTheRootTurnsInstead) {
  // A mimic joint of the other leg follows the hip's joint about the vertical.
  RobotTree tree = OneLeg("zxyyyx");
  const Sole other{AddJoint(tree, "other", 0, Offset(0, -0.1, 0), {0, 1, 0})};
  MakeLastJointMimic(tree, 0, 1.0, 0.0);
  const LegChain leg(tree, {FindLink(tree, "sole")}, {other});
  EXPECT_TRUE(leg.turns_root());
  EXPECT_EQ(leg.shared_coordinates(), std::vector<int>{0});
  EXPECT_EQ(leg.coordinates().size(), 5u);
  Eigen::VectorXd q(6);
  q << 0, 0.05, kHip, kKnee, kHip, 0;
  Transform T_world_root = Transform(Offset(0.2, 0.1, 0.8)) * RotX(0.1) * RotY(0.05);
  const Transform T_world_sole = T_world_root * leg.SolePose(q);
  const Eigen::Vector3d place = T_world_root.translation() + Eigen::Vector3d(0.02, 0.01, 0.02);
  T_world_root.translation() = place;
  const Eigen::Matrix3d before = T_world_root.linear();
  q[0] = 0.3;
  Eigen::VectorXd held = q;
  EXPECT_FALSE(leg.Place(T_world_root.inverse() * T_world_sole, held));
  ASSERT_TRUE(leg.PlaceUnderRoot(T_world_sole, T_world_root, q));
  EXPECT_LT(((T_world_root * leg.SolePose(q)).matrix() - T_world_sole.matrix()).norm(), 1e-9);
  EXPECT_EQ(q[0], 0.3);
  EXPECT_EQ(T_world_root.translation(), place);
  const Eigen::Vector3d turn = RotationVector(T_world_root.linear() * before.transpose());
  EXPECT_NEAR(turn.z(), -0.3, 0.02);  // what the hip turns the leg, apart from its lean
  EXPECT_LT(turn.head<2>().norm(), 1e-9);

  const RobotTree alone = OneLeg("zxyyyx");
  EXPECT_FALSE(LegChain(alone, {FindLink(alone, "sole")}).turns_root());
  RobotTree short_leg = OneLeg("zxyyy");
  const Sole second{AddJoint(short_leg, "other", 0, Offset(0, -0.1, 0), {0, 1, 0})};
  MakeLastJointMimic(short_leg, 0, 1.0, 0.0);
  ExpectInputError([&] { LegChain(short_leg, {FindLink(short_leg, "sole")}, {second}); },
                   {"'sole'", "5 joints, 4 of them its own", "five or more joints of its own"});
}

TEST(LegChain, OfThreeJointsPlacesABallWhateverItsAttitude) {
  const RobotTree tree = OneLeg("xyy");
  const LegChain leg(tree, {FindLink(tree, "sole"), {0, 0}, {0, 0}, 0.02});
  Eigen::VectorXd q(3);
  q << 0.1, kHip, kKnee;
  Transform wanted = leg.SolePose(q);
  wanted.translation() += Eigen::Vector3d(0.03, -0.04, 0.05);
  wanted.linear() = RotX(0.7).linear();
  ASSERT_TRUE(leg.Place(wanted, q));
  EXPECT_LT((leg.SolePose(q).translation() - wanted.translation()).norm(), 1e-10);
  EXPECT_GT(RotationAngle(leg.SolePose(q).linear().transpose() * wanted.linear()), 0.1);
  ExpectInputError([&] { LegChain(tree, {FindLink(tree, "sole")}); }, {"3 joints", "five or more"});
}

TEST(LegChain, OfFourJointsOnABallGoesByThePlaceAlone) {
  const RobotTree tree = OneLeg("zxyy");
  LegChain leg(tree, {FindLink(tree, "sole"), {0, 0}, {0, 0}, 0.0});
  Eigen::VectorXd rest(4);
  rest << 0.0, 0.1, kHip, kKnee;
  leg.Prefer(rest);
  Transform wanted = leg.SolePose(rest);
  wanted.translation() += Eigen::Vector3d(0.03, -0.02, 0.05);
  Eigen::VectorXd there = rest, by_detour = rest;
  ASSERT_TRUE(leg.Place(wanted, there));
  Transform detour = wanted;
  detour.translation() += Eigen::Vector3d(-0.05, 0.03, 0.02);
  ASSERT_TRUE(leg.Place(detour, by_detour));
  ASSERT_TRUE(leg.Place(wanted, by_detour));
  EXPECT_LT((there - by_detour).cwiseAbs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace elastocal
