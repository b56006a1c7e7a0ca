// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/stand_through.hpp"

#include <gtest/gtest.h>

#include "elastocal/simulation/postures.hpp"
#include "tests/biped.hpp"

namespace elastocal {
namespace {

class BipedStandsThrough : public testing::Test {
 protected:
  BipedStandsThrough() {
    const auto legs = FindLegs(biped_.tree, biped_.chains);
    robot_ = NominalRobot(biped_.tree, biped_.markers, legs, {});
    stand_ = PostureSampler(biped_.tree, legs, {}, 1).stand();
    for (const Leg& leg : legs) soles_.push_back({leg.foot_link, {-0.1, -0.06}, {0.1, 0.06}});
  }

  /// A bow: the trunk's pitch goes to `pitch` in two seconds, then the robot rests for one.
  JointMotion Bow(double pitch) const {
    JointMotion motion;
    motion.time_s = Eigen::VectorXd::LinSpaced(31, 0.0, 3.0);
    motion.q = stand_.transpose().replicate(31, 1);
    for (int i = 0; i < 31; ++i) motion.q(i, 1) += pitch * std::min(1.0, i / 20.0);
    motion.support.assign(31, {soles_[0].link, soles_[1].link});
    return motion;
  }

  /// The ankles lean forwards, and nothing moves backwards in return.
  JointMotion TooFar() const {
    JointMotion motion = Bow(0.0);
    for (int i = 0; i < 31; ++i) {
      for (const Leg& leg : robot_.legs) {
        motion.q(i, leg.joints[4]) += 0.4 * std::min(1.0, i / 20.0);
      }
    }
    return motion;
  }

  /// Makes the trunk heavier in front than described.
  void PutWeightAhead(double distance) {
    RobotTree& tree = robot_.tree;
    tree.links[static_cast<std::size_t>(tree.joints[1].child_link)].com.x() += distance;
  }

  Biped biped_ = MakeBiped();
  TrueRobot robot_;
  Eigen::VectorXd stand_;
  std::vector<Sole> soles_;
};

TEST_F(BipedStandsThrough, StandsAndPressesWhereStaticsSay) {
  const StandingRun run = StandThrough(robot_, soles_, Bow(0.0), {});
  EXPECT_TRUE(run.stood);
  EXPECT_NEAR(run.time_s, 3.0, 0.01);
  EXPECT_LT(run.largest_lean, 1e-3);
  EXPECT_LT(run.tracking, 0.01);  // servos give way by torque over 5e4 N.m/rad
  // The nearest edge is the front or the back one, depending on the centre of mass.
  const Eigen::Vector3d com = CentreOfMass(biped_.tree, BodyInertias(biped_.tree), stand_);
  const double x =
      (LinkTransforms(biped_.tree, stand_)[static_cast<std::size_t>(soles_[0].link)].inverse() *
       com)
          .x();
  // The floor gives way by hundredths of a millimetre. The legs lean by some milliradians at 0.9 m.
  EXPECT_NEAR(run.least_zmp_margin, 0.1 - std::abs(x), 0.006);
}

TEST_F(BipedStandsThrough, FallsWhereItBowsTooFar) {
  const StandingRun run = StandThrough(robot_, soles_, TooFar(), {});
  EXPECT_FALSE(run.stood);
  EXPECT_LT(run.time_s, 3.0);
}

// The robot stands and falls as before, though its root link is as low as the soles.
TEST_F(BipedStandsThrough, WithARootLinkOnTheFloor) {
  const Eigen::Vector3d up(0.0, 0.0, StandingHeight(robot_.tree, robot_.legs));
  robot_.tree.links[0].com += up;
  for (Joint& joint : robot_.tree.joints) {
    if (joint.parent_link == 0) joint.T_parent_child.translation() += up;
  }
  EXPECT_TRUE(StandThrough(robot_, soles_, Bow(0.0), {}).stood);
  EXPECT_FALSE(StandThrough(robot_, soles_, TooFar(), {}).stood);
}

TEST_F(BipedStandsThrough, AStabiliserKeepsItOverItsFeet) {
  // A motion that is planned to stay 4 cm inside leaves the support polygon.
  PutWeightAhead(0.1);
  JointMotion motion = Bow(0.0);
  motion.time_s = Eigen::VectorXd::LinSpaced(31, 0.0, 24.0);
  for (int i = 0; i < 31; ++i) motion.q(i, 1) += 0.5 * std::clamp((i - 15) / 10.0, 0.0, 1.0);
  EXPECT_FALSE(StandThrough(robot_, soles_, motion, {}).stood);
  Stabiliser stabiliser(biped_.tree, soles_);
  const StandingRun run = StandThrough(robot_, soles_, motion, {}, {.stabiliser = &stabiliser});
  EXPECT_TRUE(run.stood);
  EXPECT_NEAR(run.largest_shift, 29.0 / 60.0 * 0.1, 0.015);
}

// The centre of mass is ahead of the toes. The robot falls as soon as it is put down, unless hands
// hold it until the stabiliser has shifted it back.
TEST_F(BipedStandsThrough, HandsHoldItWhileItIsPutDown) {
  PutWeightAhead(0.16);
  JointMotion motion = Bow(0.0);
  motion.time_s = Eigen::VectorXd::LinSpaced(31, 0.0, 6.0);
  const StandingRun alone = StandThrough(robot_, soles_, motion, {});
  EXPECT_FALSE(alone.stood);
  EXPECT_LT(alone.time_s, 0.1);  // it has fallen before the motion begins
  EXPECT_LT(alone.least_zmp_margin, 0.0);
  Stabiliser stabiliser(biped_.tree, soles_);
  EXPECT_TRUE(StandThrough(robot_, soles_, motion, {}, {.stabiliser = &stabiliser}).stood);
}

// The ankles are off by 10 mrad, so that the root link leans, although by the model it does not.
// The stabiliser uses the inertial unit to set it upright, unless the unit was mounted in that
// rest.
TEST_F(BipedStandsThrough, TheInertialUnitIsMountedAsTheFirstRestShows) {
  constexpr double kLean = 0.01;
  JointMotion motion = Bow(0.0);
  motion.time_s = Eigen::VectorXd::LinSpaced(31, 0.0, 12.0);
  Eigen::MatrixXd commanded = motion.q;
  for (const Leg& leg : robot_.legs) commanded.col(leg.joints[4]).array() += kLean;
  const auto turn = [&](const std::optional<Eigen::Matrix3d>& R_world_root_at_rest) {
    Stabiliser stabiliser(biped_.tree, soles_);
    const StandingRun run = StandThrough(robot_, soles_, motion, {},
                                         {.stabiliser = &stabiliser,
                                          .R_world_root_at_rest = R_world_root_at_rest,
                                          .commanded = &commanded});
    EXPECT_TRUE(run.stood);
    return stabiliser.turn().norm();
  };
  EXPECT_NEAR(turn(std::nullopt), kLean, 0.3 * kLean);
  EXPECT_LT(turn(Eigen::Matrix3d::Identity()), 0.1 * kLean);
}

// The trunk is heavier in front than described, which does not change the kinematics.
TEST_F(BipedStandsThrough, MassesThatAreOffInTheFirstRestMoveNoRootThatIsKnown) {
  PutWeightAhead(0.03);
  JointMotion motion = Bow(0.0);
  motion.time_s = Eigen::VectorXd::LinSpaced(31, 0.0, 12.0);
  const auto shift = [&](const std::optional<Eigen::Matrix3d>& R_world_root_at_rest) {
    Stabiliser stabiliser(biped_.tree, soles_);
    const StandingRun run =
        StandThrough(robot_, soles_, motion, {},
                     {.stabiliser = &stabiliser, .R_world_root_at_rest = R_world_root_at_rest});
    EXPECT_TRUE(run.stood);
    return stabiliser.shift().norm();
  };
  constexpr double kOff = 29.0 / 60.0 * 0.03;
  EXPECT_NEAR(shift(std::nullopt), kOff, 0.3 * kOff);
  EXPECT_LT(shift(Eigen::Matrix3d::Identity()), 0.1 * kOff);
}

// If no posture on one leg has the other foot in its workspace, the robot is held.
TEST(PostureSampler, StandsOnlyWherePosturesOnEitherLegAreFound) {
  const Biped biped = MakeBiped();
  const auto legs = FindLegs(biped.tree, biped.chains);
  EXPECT_TRUE(PostureSampler(biped.tree, legs, {}, 1).stands());
  PostureOptions options;
  options.foot.lower.z() = 1.0;  // above the root link
  options.foot.upper.z() = 1.2;
  EXPECT_FALSE(PostureSampler(biped.tree, legs, options, 1).stands());
}

}  // namespace
}  // namespace elastocal
