// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/correction_room.hpp"

#include <cmath>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/calibration/options.hpp"
#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/drafting/draft.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/draft_files.hpp"

namespace elastocal {
namespace {

std::string SegmentText(const std::string& name) {
  return "<link name='" + name +
         "'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' "
         "izz='0.01'/></inertial></link>";
}

std::string HingeText(const std::string& parent, const std::string& child,
                      const std::string& origin, const std::string& axis,
                      const std::string& limits) {
  return SegmentText(child) + "<joint name='" + child + "_joint' type='revolute'><parent link='" +
         parent + "'/><child link='" + child + "'/><origin " + origin + "/><axis xyz='" + axis +
         "'/><limit " + limits + " effort='1e6' velocity='2'/></joint>";
}

/// An arm with a shoulder of three axes, an upper arm of 0.3 m, a forearm of 0.2 m and a wrist. In
/// the zero posture the elbow is bent by `bent`; its limits are `limits`.
std::string ArmUrdf(double bent, const std::string& limits) {
  const std::string wide = "lower='-1.5' upper='1.5'";
  return "<robot name='arm'>" + SegmentText("base") +
         HingeText("base", "s1", "xyz='0 0 1'", "0 1 0", wide) +
         HingeText("s1", "s2", "xyz='0 0 0'", "1 0 0", wide) +
         HingeText("s2", "s3", "xyz='0 0 -0.1'", "0 0 1", wide) +
         HingeText("s3", "elbow", "xyz='0 0 -0.2' rpy='0 " + std::to_string(bent) + " 0'", "0 1 0",
                   limits) +
         HingeText("elbow", "w1", "xyz='0 0 -0.15'", "0 0 1", wide) +
         HingeText("w1", "w2", "xyz='0 0 -0.05'", "1 0 0", wide) + "</robot>";
}

Limb ArmOf(const RobotTree& tree) {
  Limb limb;
  limb.name = "arm";
  limb.tip_body = static_cast<int>(tree.joints.size());
  limb.tip_link = FindLink(tree, "w2");
  for (int k = 0; k < limb.tip_body; ++k) limb.joints.push_back(k);
  return limb;
}

TEST(CorrectionRoom, FindsTheElbowAndWhereItIsStraight) {
  const RobotTree tree = ParseUrdf(ArmUrdf(0.4, "lower='-2' upper='2'"), "arm.urdf");
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  q << 0.3, -0.5, 0.7, 0.9, 0.2, -0.4;
  const Hinge hinge = FindHinge(tree, ArmOf(tree), q);
  ASSERT_GE(hinge.joint, 0);
  EXPECT_EQ(tree.joints[Size(hinge.joint)].name, "elbow_joint");
  EXPECT_NEAR(hinge.straight, -0.4, 1e-6);
  EXPECT_NEAR(hinge.upper, 0.3, 1e-4);
  EXPECT_NEAR(hinge.lower, 0.2, 1e-4);
}

// The law of cosines: with parts of 0.3 and 0.2 m, 0.48 m remain at 0.4107 rad.
TEST(CorrectionRoom, TheBendFollowsFromTheLengthThatIsNeeded) {
  const Hinge hinge{0, 0.0, 0.3, 0.2};
  const double bend = BendForLength(hinge, 0.02);
  EXPECT_NEAR(0.09 + 0.04 + 0.12 * std::cos(bend), 0.48 * 0.48, 1e-12);
  EXPECT_NEAR(bend, 0.5791, 1e-3);
  EXPECT_EQ(BendForLength(hinge, 0.0), 0.0);
  EXPECT_NEAR(BendForLength(hinge, 1.0), M_PI, 1e-9);
}

// Drawn errors displace the hand as expected; loads are too small for the stiff motors to count.
TEST(CorrectionRoom, DisplacementsAreThoseOfDrawnErrors) {
  const RobotTree tree = ParseUrdf(ArmUrdf(0.4, "lower='-2' upper='2'"), "arm.urdf");
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(tree.coordinate_count(), 0.3);
  const int tip = FindLink(tree, "w2");
  const ErrorModel model = MakeErrorModel(tree, {{"tip", tip, Eigen::Vector3d::Zero()}});
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.parameter_count());
  const Eigen::Vector3d nominal = MarkerPositions(model, ApplyErrors(model, zero), q).col(0);
  Random random(3);
  constexpr int kRobots = 3000;
  double squares = 0.0;
  for (int i = 0; i < kRobots; ++i) {
    Eigen::VectorXd errors = zero;
    for (int p = 0; p < errors.size(); ++p) {
      if (model.parameters[Size(p)].joint < 0) continue;
      errors[p] = random.Normal(Prior().Of(tree, model.parameters[Size(p)]));
    }
    squares +=
        (MarkerPositions(model, ApplyErrors(model, errors), q).col(0) - nominal).squaredNorm();
  }
  const double drawn = std::sqrt(squares / (3.0 * kRobots));
  // A standard deviation of 3000 draws of a few independent errors is known to 2 %.
  EXPECT_NEAR(ExpectedDisplacement(tree, tip, q) / drawn, 1.0, 0.06);
}

// A URDF may have placeholders for efforts. A joint that carries its load gives way by 0.01 rad
// under it at most (one standard deviation).
TEST(CorrectionRoom, AnEffortThatCannotBeMakesNoSoftRobot) {
  const auto displacement = [](const std::string& effort) {
    const std::string urdf =
        std::regex_replace(ArmUrdf(0.4, "lower='-2' upper='2'"), std::regex("effort='1e6'"),
                           "effort='" + effort + "'");
    const RobotTree tree = ParseUrdf(urdf, "arm.urdf");
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(tree.coordinate_count(), 0.3);
    return ExpectedDisplacement(tree, FindLink(tree, "w2"), q);
  };
  const double soft = displacement("1e-3");
  EXPECT_GT(soft, 1.05 * displacement("1e6"));
  EXPECT_NEAR(soft, displacement("1e-6"), 1e-12);
  EXPECT_LT(soft, 0.01);
}

// Six joints undo an error entirely: at the hand nothing would be left, at the elbow something is.
TEST(CorrectionRoom, CorrectionsAreAsLargeAsTheErrorsThatTheyUndo) {
  const RobotTree tree = ParseUrdf(ArmUrdf(0.4, "lower='-2' upper='2'"), "arm.urdf");
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  q << 0.3, 0.6, 0.7, 0.9, 0.2, 0.8;
  const ExpectedCorrection expected = ExpectCorrection(tree, ArmOf(tree), q);
  ASSERT_EQ(expected.joints.size(), 6U);
  // Zeros of 0.5 degrees are part of each error.
  for (const auto& [c, sd] : expected.joints) EXPECT_GT(sd, 0.5 * kRadiansPerDegree) << c;
  EXPECT_GT(expected.displacement, 0.001);
  EXPECT_LT(expected.displacement, 0.02);
}

TEST(CorrectionRoom, ManyCorrectionsNeedMoreRoomThanOne) {
  EXPECT_NEAR(RoomSds(1), 1.645, 1e-3);  // 95 % of a normal distribution
  EXPECT_NEAR(RoomSds(30), 2.935, 1e-3);
}

TEST(CorrectionRoom, ElbowsStayBentWhereTheyBendOneWay) {
  const auto ranges = [](const std::string& limits) {
    const RobotTree tree = ParseUrdf(ArmUrdf(0.0, limits), "arm.urdf");
    Limbs limbs;
    limbs.limbs.push_back(ArmOf(tree));
    return BentRanges(tree, limbs, Eigen::VectorXd::Constant(tree.coordinate_count(), 0.3));
  };
  const auto one_way = ranges("lower='-0.1' upper='2.4'");
  ASSERT_EQ(one_way.size(), 1U);
  EXPECT_EQ(one_way[0].range[1], 2.4);
  const RobotTree tree = ParseUrdf(ArmUrdf(0.0, "lower='-0.1' upper='2.4'"), "arm.urdf");
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(tree.coordinate_count(), 0.3);
  const Hinge hinge = FindHinge(tree, ArmOf(tree), q);
  const double room = RoomSds(1) * ExpectedDisplacement(tree, FindLink(tree, "w2"), q);
  EXPECT_NEAR(one_way[0].range[0], BendForLength(hinge, room), 1e-9);
  EXPECT_GT(one_way[0].range[0], 15.0 * kRadiansPerDegree);
  EXPECT_NEAR(ranges("lower='-2.4' upper='0.1'")[0].range[1], -one_way[0].range[0], 0.02);
  EXPECT_TRUE(ranges("lower='-2.4' upper='2.4'").empty()) << "it bends either way";
  EXPECT_TRUE(ranges("lower='1' upper='2.4'").empty()) << "it is always bent";
  // Half of a short range is kept.
  EXPECT_NEAR(ranges("lower='0' upper='0.3'")[0].range[0], 0.15, 1e-9);
}

}  // namespace
}  // namespace elastocal
