// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/true_robot.hpp"

#include <gtest/gtest.h>

#include "elastocal/robot/statics.hpp"
#include "tests/biped.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

TrueRobot Nominal() {
  const Biped biped = MakeBiped();
  return NominalRobot(biped.tree, biped.markers, FindLegs(biped.tree, biped.chains), {1});
}

double Rms(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()))
             .norm() /
         std::sqrt(static_cast<double>(values.size()));
}

/// The default options without the factors that scale all errors of one kind.
TruthOptions Unscaled() {
  TruthOptions options;
  options.upper_geometry_scale = options.leg_geometry_scale = 1.0;
  options.upper_elasticity_scale = options.leg_elasticity_scale = 1.0;
  return options;
}

TEST(FindLegs, AreTheChainsDownToTheFloor) {
  const Biped biped = MakeBiped();
  const std::vector<Leg> legs = FindLegs(biped.tree, biped.chains);
  ASSERT_EQ(legs.size(), 2u);
  EXPECT_EQ(legs[0].chain, "left");
  EXPECT_EQ(biped.tree.links[static_cast<std::size_t>(legs[1].foot_link)].name, "right_sole");
  EXPECT_EQ(legs[0].joints, (std::vector<int>{2, 3, 4, 5, 6, 7}));
  EXPECT_NEAR(StandingHeight(biped.tree, legs), 0.27 + 0.38 + 0.325 + 0.107, 1e-12);
  EXPECT_TRUE(InLeg(legs, 13));
  EXPECT_FALSE(InLeg(legs, 1));
}

TEST(FindLegs, TheRootLinkMayBeAFrameOnTheFloor) {
  Biped biped = MakeBiped();
  for (Joint& joint : biped.tree.joints) {
    if (joint.parent_link == 0) joint.T_parent_child.translation().z() += 1.082;
  }
  const std::vector<Leg> legs = FindLegs(biped.tree, biped.chains);
  ASSERT_EQ(legs.size(), 2u);
  EXPECT_EQ(legs[0].chain, "left");
  EXPECT_NEAR(StandingHeight(biped.tree, legs), 1.082 - 0.27, 1e-12);  // height of the hips
  // A single leg would be taken for an arm that hangs down to the floor.
  EXPECT_TRUE(FindLegs(biped.tree, {biped.chains[0]}).empty());
}

TEST(FindLegs, AnArmOnATableHasNone) {
  const RobotTree tree = PlanarArm();
  EXPECT_TRUE(FindLegs(tree, {{"arm", 0, 3}}).empty());
}

TEST(DrawTrueRobot, ErrorsHaveTheirSizes) {
  const TrueRobot nominal = Nominal();
  std::vector<double> leg_offsets, upper_offsets, shifts, turns, markers, masses;
  TruthOptions options = Unscaled();
  for (options.seed = 1; options.seed <= 100; ++options.seed) {
    const TrueRobot robot = DrawTrueRobot(nominal, options);
    for (std::size_t k = 0; k < robot.tree.joints.size(); ++k) {
      (k < 2 ? upper_offsets : leg_offsets).push_back(robot.offset[static_cast<int>(k)]);
      const Transform error =
          nominal.tree.joints[k].T_parent_child.inverse() * robot.tree.joints[k].T_parent_child;
      for (const double x : error.translation()) shifts.push_back(x);
      turns.push_back(RotationAngle(error.linear()));
      const double stiffness = 1.0 / robot.compliance[static_cast<int>(k)];
      EXPECT_GE(stiffness, k < 2 ? options.upper_stiffness_least : options.leg_stiffness_least);
      EXPECT_LE(stiffness, k < 2 ? options.upper_stiffness_most : options.leg_stiffness_most);
    }
    for (std::size_t m = 0; m < robot.markers.size(); ++m) {
      for (const double x :
           Eigen::Vector3d(robot.markers[m].p_link_marker - nominal.markers[m].p_link_marker)) {
        markers.push_back(x);
      }
    }
    masses.push_back(robot.tree.links[0].mass / 12.0 - 1.0);
  }
  // The root mean square of n normal numbers is known to sd / sqrt(2 n). The tolerance is 5 times
  // that.
  const auto near = [](const std::vector<double>& values, double sd) {
    EXPECT_NEAR(Rms(values), sd, 5.0 * sd / std::sqrt(2.0 * static_cast<double>(values.size())));
  };
  near(leg_offsets, options.leg_offset_sd);
  near(upper_offsets, options.upper_offset_sd);
  near(shifts, options.length_sd);
  near(markers, options.marker_sd);
  near(masses, options.mass_sd);
  near(turns, std::sqrt(3.0) * options.angle_sd);
}

// A slide with the number for turning joints would be so soft that it sags by centimetres.
TEST(DrawTrueRobot, SlidesHaveARangeOfTheirOwn) {
  const TrueRobot turning = Nominal();
  TrueRobot sliding = turning;
  for (const std::size_t k : {1u, 4u}) sliding.tree.joints[k].type = JointType::kPrismatic;
  TruthOptions options = Unscaled();
  for (options.seed = 1; options.seed <= 20; ++options.seed) {
    const Eigen::VectorXd others = DrawTrueRobot(turning, options).compliance;
    const Eigen::VectorXd compliance = DrawTrueRobot(sliding, options).compliance;
    for (Eigen::Index k = 0; k < compliance.size(); ++k) {
      if (k != 1 && k != 4) {
        EXPECT_EQ(compliance[k], others[k]) << k;
        continue;
      }
      EXPECT_GE(1.0 / compliance[k], options.slide_stiffness_least);
      EXPECT_LE(1.0 / compliance[k], options.slide_stiffness_most);
    }
  }
}

TEST(DrawTrueRobot, ScalesAndSwitchesOffWhatTheyName) {
  const TrueRobot nominal = Nominal();
  TruthOptions options = Unscaled();
  const TrueRobot before = DrawTrueRobot(nominal, options);
  options.leg_geometry_scale = 2.0;
  options.upper_elasticity_scale = 0.0;
  options.mass_sd = 0.0;
  const TrueRobot after = DrawTrueRobot(nominal, options);
  EXPECT_DOUBLE_EQ(after.offset[5], 2.0 * before.offset[5]);
  EXPECT_EQ(after.offset[0], before.offset[0]);
  EXPECT_EQ(after.compliance[0], 0.0);
  EXPECT_EQ(after.compliance[5], before.compliance[5]);
  EXPECT_EQ(after.tree.links[0].mass, 12.0);
  EXPECT_EQ(after.tree.links[0].com, before.tree.links[0].com);
  EXPECT_EQ(after.torque_bias, before.torque_bias);
  EXPECT_EQ(after.markers[3].p_link_marker, before.markers[3].p_link_marker);
}

// Such robots exist: one of 4.9 tonnes (a KR 210 by its URDF), one with efforts of 50000 N.m (an
// ergoCub).
TEST(DrawTrueRobot, SpringsAndFrictionFitTheRobotsWeight) {
  const TrueRobot usual = Nominal();
  const TrueRobot drawn = DrawTrueRobot(usual, Unscaled());
  TrueRobot heavy = usual;
  for (Link& link : heavy.tree.links) link.mass *= 1e3;
  const TrueRobot stiff = DrawTrueRobot(heavy, Unscaled());
  const Eigen::VectorXd torques = LargestGravityTorques(heavy.tree);
  EXPECT_GT((torques.head(2).array() * drawn.compliance.head(2).array()).maxCoeff(), 0.02);
  EXPECT_LT((torques.head(2).array() * stiff.compliance.head(2).array()).maxCoeff(), 0.011);
  EXPECT_EQ(stiff.compliance[5], drawn.compliance[5]);  // a leg, which must carry the robot

  TrueRobot strong = usual;
  strong.tree.joints[0].limits.effort = 5e4;
  EXPECT_LT(DrawTrueRobot(strong, Unscaled()).friction[0], 0.1 * Unscaled().friction_share * 5e4);
  EXPECT_EQ(DrawTrueRobot(strong, Unscaled()).friction[1], drawn.friction[1]);
}

TEST(DrawTrueRobot, OneLinkIsHeavierAndOneMarkerCreeps) {
  TruthOptions options = Unscaled();
  const TrueRobot nominal = Nominal();
  const TrueRobot before = DrawTrueRobot(nominal, options);
  options.heavy_link = nominal.tree.links[0].name;
  options.heavy_share = 0.1;
  options.creeping_marker = nominal.markers[1].name;
  options.creep = 1e-3;
  const TrueRobot after = DrawTrueRobot(nominal, options);
  EXPECT_DOUBLE_EQ(after.tree.links[0].mass, 1.1 * before.tree.links[0].mass);
  EXPECT_EQ(after.tree.links[1].mass, before.tree.links[1].mass);
  EXPECT_EQ(after.creeping_marker, 1);
  EXPECT_EQ(after.creep, 1e-3);
  options.creeping_marker = "nowhere";
  ExpectInputError([&] { DrawTrueRobot(nominal, options); }, {"nowhere", "no marker"});
}

TEST(DrawTrueRobot, LinksOfLegsGiveWayAndNoOthers) {
  const TruthOptions options = Unscaled();
  const TrueRobot robot = DrawTrueRobot(Nominal(), options);
  EXPECT_TRUE(robot.link_compliance[0].isZero());
  EXPECT_TRUE(robot.link_compliance[1].isZero());
  for (const Leg& leg : robot.legs) {
    for (std::size_t i = 0; i < 6; ++i) {
      const Vector6d& expected = i == 0   ? options.pelvis_compliance
                                 : i <= 3 ? options.hip_link_compliance
                                          : options.shank_link_compliance;
      const Vector6d ratio =
          robot.link_compliance[static_cast<std::size_t>(leg.joints[i])].cwiseQuotient(expected);
      EXPECT_GE(ratio.minCoeff(), 0.7);
      EXPECT_LE(ratio.maxCoeff(), 1.3);
    }
  }
  EXPECT_EQ(robot.torque_sensor[1], true);
  EXPECT_EQ(robot.torque_sensor[2], false);
}

}  // namespace
}  // namespace elastocal
