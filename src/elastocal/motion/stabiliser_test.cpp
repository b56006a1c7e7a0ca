// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/stabiliser.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/rotation_vector.hpp"
#include "tests/biped.hpp"

namespace elastocal {
namespace {

class BipedStabiliser : public testing::Test {
 protected:
  BipedStabiliser() {
    for (const char* name : {"left", "right"}) {
      for (const auto& [joint, bent] : {std::pair("_3", -0.3), {"_4", 0.6}, {"_5", -0.3}}) {
        const int k = FindJoint(tree_, std::string(name) + joint);
        planned_[tree_.joints[static_cast<std::size_t>(k)].coordinate] = bent;
      }
    }
    const LegChain left(tree_, soles_[0]), right(tree_, soles_[1]);
    T_root_sole_ = {left.SolePose(planned_), right.SolePose(planned_)};
    const Eigen::Vector3d com = CentreOfMass(tree_, BodyInertias(tree_), planned_);
    sense_.wrenches.setZero(6, 2);
    const double y[] = {T_root_sole_[0].translation().y(), T_root_sole_[1].translation().y()};
    for (Eigen::Index i = 0; i < 2; ++i) {  // lever rule; pressure below the centre of mass
      const double share = (com.y() - y[1 - i]) / (y[i] - y[1 - i]);
      const double ahead = com.x() - T_root_sole_[static_cast<std::size_t>(i)].translation().x();
      const double force = 2.0 * kHalf * share;
      sense_.wrenches.col(i) << 0.0, 0.0, force, 0.0, -force * ahead, 0.0;
    }
  }

  /// The root link's pose in the first sole after ten steps of 10 ms, relative to the planned pose.
  Transform RootMoved() {
    Stabiliser stabiliser(tree_, soles_);
    Eigen::VectorXd q;
    for (int i = 0; i < 10; ++i) {
      q = stabiliser.Correct(planned_, {soles_[0].link, soles_[1].link}, sense_, 0.01);
    }
    const LegChain left(tree_, soles_[0]);
    return left.SolePose(q).inverse() * T_root_sole_[0];
  }

  static constexpr double kHalf = 300.0;  // N
  Biped biped_ = MakeBiped();
  const RobotTree& tree_ = biped_.tree;
  std::vector<Sole> soles_ = {{FindLink(biped_.tree, "left_sole"), {-0.1, -0.06}, {0.1, 0.06}},
                              {FindLink(biped_.tree, "right_sole"), {-0.1, -0.06}, {0.1, 0.06}}};
  Eigen::VectorXd planned_ = Eigen::VectorXd::Zero(biped_.tree.coordinate_count());
  std::vector<Transform> T_root_sole_;
  StandingSense sense_;
};

TEST_F(BipedStabiliser, LeavesAloneWhatStandsAsPlanned) {
  const Transform moved = RootMoved();
  EXPECT_LT(moved.translation().norm(), 1e-9);
  EXPECT_LT(RotationVector(moved.linear()).norm(), 1e-9);
}

TEST_F(BipedStabiliser, TurnsBackARootThatLeansForwards) {
  sense_.R_world_root = RotationFromVector({0.0, 0.05, 0.0});
  const Eigen::Vector3d turn = RotationVector(RootMoved().linear());
  const double sway = std::sqrt(9.81 / LegChain(tree_, soles_[0]).length());
  EXPECT_NEAR(turn.y(), -0.24 * sway * 0.1 * 0.05, 1e-5);  // rate, time, error
  EXPECT_NEAR(turn.x(), 0.0, 1e-5);
}

TEST_F(BipedStabiliser, DoesNotMindTheHeading) {
  sense_.R_world_root = RotationFromVector({0.0, 0.0, 0.7});
  EXPECT_LT(RotationVector(RootMoved().linear()).norm(), 1e-9);
}

TEST_F(BipedStabiliser, ShiftsBackWhatPressesAheadOfItsPlan) {
  for (Eigen::Index i = 0; i < 2; ++i) sense_.wrenches(4, i) -= kHalf * 0.03;  // 3 cm ahead
  const Transform moved = RootMoved();
  EXPECT_LT(moved.translation().x(), -1e-5);
  EXPECT_NEAR(moved.translation().y(), 0.0, 1e-6);
}

// The kinematics are known, so a load that is off at rest comes from masses. Only what is added
// later moves the robot.
TEST_F(BipedStabiliser, LeavesAloneWhatWasOffInTheRest) {
  for (Eigen::Index i = 0; i < 2; ++i) sense_.wrenches(4, i) -= kHalf * 0.03;  // 3 cm ahead
  const std::vector<int> support = {soles_[0].link, soles_[1].link};
  Stabiliser stabiliser(tree_, soles_);
  stabiliser.TakeRest(planned_, support, sense_);
  for (int i = 0; i < 10; ++i) stabiliser.Correct(planned_, support, sense_, 0.01);
  EXPECT_LT(stabiliser.shift().norm(), 1e-9);
  for (Eigen::Index i = 0; i < 2; ++i) sense_.wrenches(4, i) -= kHalf * 0.03;
  for (int i = 0; i < 10; ++i) stabiliser.Correct(planned_, support, sense_, 0.01);
  EXPECT_LT(stabiliser.shift().x(), -1e-5);
}

TEST_F(BipedStabiliser, TurnsFeetUntilBothArePressedAlike) {
  sense_.wrenches(4, 0) -= kHalf * 0.05;  // the left foot presses on its toes: lift them
  sense_.wrenches(4, 1) += kHalf * 0.05;  // the right foot presses on its heel
  Stabiliser stabiliser(tree_, soles_);
  Eigen::VectorXd q;
  for (int i = 0; i < 10; ++i) {
    q = stabiliser.Correct(planned_, {soles_[0].link, soles_[1].link}, sense_, 0.01);
  }
  const auto turned = [&](std::size_t i) {
    const Eigen::Matrix3d R = LegChain(tree_, soles_[i]).SolePose(q).linear();
    return RotationVector(T_root_sole_[i].linear().transpose() * R).y();
  };
  EXPECT_NEAR(turned(0), -0.16 / 0.812 * 0.1 * 0.1, 1e-5);  // rate, distance, time
  EXPECT_NEAR(turned(1), 0.16 / 0.812 * 0.1 * 0.1, 1e-5);
}

TEST_F(BipedStabiliser, LiftsAFootThatIsTooLow) {
  // The left leg is too long, so that both soles are pressed 2 cm towards the middle of the robot.
  sense_.wrenches(3, 0) -= sense_.wrenches(2, 0) * 0.02;
  sense_.wrenches(3, 1) -= sense_.wrenches(2, 1) * 0.02;
  Stabiliser stabiliser(tree_, soles_);
  Eigen::VectorXd q;
  for (int i = 0; i < 10; ++i) {
    q = stabiliser.Correct(planned_, {soles_[0].link, soles_[1].link}, sense_, 0.01);
  }
  const LegChain left(tree_, soles_[0]), right(tree_, soles_[1]);
  const double lifted = (right.SolePose(q).inverse() * left.SolePose(q)).translation().z() -
                        (T_root_sole_[1].inverse() * T_root_sole_[0]).translation().z();
  const double width = (T_root_sole_[0].translation() - T_root_sole_[1].translation()).norm();
  EXPECT_NEAR(lifted, 0.16 / left.length() * 0.1 * width * 0.02, 1e-6);  // rate, time, distances
}

TEST_F(BipedStabiliser, RemembersWhatItLearnedOnAFoot) {
  Stabiliser stabiliser(tree_, soles_);
  const auto shift_on = [&](int foot, double ahead, int steps) {
    StandingSense sense = sense_;
    const double force = 2.0 * kHalf;
    const Eigen::Vector3d com = CentreOfMass(tree_, BodyInertias(tree_), planned_);
    const Eigen::Vector3d local = T_root_sole_[static_cast<std::size_t>(foot)].inverse() * com;
    sense.wrenches.setZero();
    sense.wrenches.col(foot) << 0.0, 0.0, force, force * local.y(), -force * (local.x() + ahead),
        0.0;
    for (int i = 0; i < steps; ++i) {
      stabiliser.Correct(planned_, {soles_[static_cast<std::size_t>(foot)].link}, sense, 0.01);
    }
    return stabiliser.shift().x();
  };
  const double left = shift_on(0, 0.02, 100);
  EXPECT_LT(left, -1e-3);
  EXPECT_GT(shift_on(1, -0.02, 100), 1e-3);
  EXPECT_LT(shift_on(0, 0.0, 1), 0.95 * left);
}

TEST_F(BipedStabiliser, LetsALiftedLegGoAsPlanned) {
  sense_.R_world_root = RotationFromVector({0.0, 0.05, 0.0});
  const int knee = FindJoint(tree_, "right_4");
  Eigen::VectorXd lifted = planned_;
  lifted[tree_.joints[static_cast<std::size_t>(knee)].coordinate] = 1.6;
  Stabiliser stabiliser(tree_, soles_);
  const Eigen::VectorXd q = stabiliser.Correct(lifted, {soles_[0].link}, sense_, 0.01);
  const LegChain left(tree_, soles_[0]), right(tree_, soles_[1]);
  EXPECT_TRUE(right.SolePose(q).isApprox(right.SolePose(lifted), 1e-12));
  EXPECT_FALSE(left.SolePose(q).isApprox(left.SolePose(lifted), 1e-6));
}

// A lifted leg that is nearly stretched cannot follow the root link's shift: it would have to swing
// far.
TEST_F(BipedStabiliser, AsksLittleOfALiftedLegThatWouldHaveToStretch) {
  const LegChain left(tree_, soles_[0]), right(tree_, soles_[1]);
  const auto position = [&](const char* joint) -> double& {
    return planned_[tree_.joints[static_cast<std::size_t>(FindJoint(tree_, joint))].coordinate];
  };
  // The leg is bent little, and reaches ahead until its foot is just above the floor.
  const auto height = [&] {
    return (left.SolePose(planned_).inverse() * right.SolePose(planned_)).translation().z();
  };
  position("right_4") = 0.4;
  for (int i = 0; height() < 0.01 && i < 100; ++i) {
    position("right_3") = -0.2 - 0.01 * i;
    position("right_5") = -0.2 + 0.01 * i;
  }
  ASSERT_NEAR(height(), 0.012, 0.002);
  // The root link turns so that the lifted leg would have to stretch fully to keep its sole in
  // place.
  sense_.R_world_root = RotationFromVector({0.05, -0.05, 0.0});
  Stabiliser stabiliser(tree_, soles_);
  const auto largest = [&](const LegChain& leg, const Eigen::VectorXd& q) {
    return Eigen::VectorXd((q - planned_)(leg.coordinates())).cwiseAbs().maxCoeff();
  };
  for (int i = 0; i < 400; ++i) {
    const Eigen::VectorXd q = stabiliser.Correct(planned_, {soles_[0].link}, sense_, 0.01);
    ASSERT_LE(largest(right, q), std::max(0.1, 2.0 * largest(left, q)) + 0.01) << i;
  }
}

}  // namespace
}  // namespace elastocal
