// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/support_check.hpp"

#include <gtest/gtest.h>

#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

class SupportCheck : public testing::Test {
 protected:
  SupportCheck() {
    // The left foot swings through 0.8 m.
    swinging_.positions.setZero(400, 3 * robot_.model.marker_count());
    for (int m = 0; m < robot_.model.marker_count(); ++m) {
      if (!robot_.model.markers[m].name.starts_with("LFOOT")) continue;
      swinging_.positions.col(3 * m).setLinSpaced(0.0, 0.8);
    }
  }
  std::optional<MovedSupport> Find(const Trial& trial) const {
    return FindMovedSupport(robot_.biped.tree, robot_.model.markers, trial, swinging_, travel_);
  }

  const StandingBiped robot_ = {};
  const MarkedRobot marked_ = {.tree = robot_.biped.tree,
                               .markers = robot_.model.markers,
                               .clusters = {},
                               .torque_sensors = {},
                               .q_not_logged = {}};
  Eigen::VectorXd travel_ =
      Eigen::VectorXd::Ones(static_cast<Eigen::Index>(robot_.biped.tree.joints.size()));
  MarkerTrajectories swinging_;
};

TEST_F(SupportCheck, TheWrongFootIsNamedWithTheRightOne) {
  const auto found = Find({.name = "swing", .chains = {}, .support = {robot_.left}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->link, robot_.left);
  EXPECT_NEAR(found->distance, 0.4, 1e-9);  // from the median, which is in the middle
  EXPECT_EQ(Describe(*found, marked_).find("the support left_sole moves by 400 mm, while "), 0u);
  ASSERT_GE(found->still, 0);
  EXPECT_EQ(robot_.biped.tree.links[found->still].body, robot_.biped.tree.links[robot_.right].body);
}

// The joints of the right leg move, but the markers that move are labelled as those of the left
// foot.
TEST_F(SupportCheck, LabelsOfTheFeetAreNamedWhereTheJointsOfTheOtherLegMove) {
  const RobotTree& tree = robot_.biped.tree;
  travel_.setConstant(0.01);
  for (const int joint : JointsToBody(tree, tree.links[robot_.right].body)) travel_[joint] = 0.5;
  const Trial trial = {.name = "swing", .chains = {}, .support = {robot_.left}};
  const auto found = Find(trial);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->labels);
  MarkedRobot marked = marked_;
  for (int m = 0; m < robot_.model.marker_count(); ++m) {
    const int body = tree.links[marked.markers[m].link].body;
    if (body == tree.links[robot_.left].body) marked.clusters.push_back({"LFOOT", {m}});
  }
  EXPECT_EQ(Describe(*found, marked).find("the labels of LFOOT and "), 0u);
  for (const int joint : JointsToBody(tree, tree.links[robot_.left].body)) travel_[joint] = 0.5;
  EXPECT_FALSE(Find(trial)->labels);
}

TEST_F(SupportCheck, BothFeetDeclaredAndOneSwings) {
  const auto found = Find({.name = "swing", .chains = {}, .support = {robot_.right, robot_.left}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->link, robot_.left);
}

TEST_F(SupportCheck, WhatStandsIsNotAccused) {
  EXPECT_FALSE(Find({.name = "right", .chains = {}, .support = {robot_.right}}));
  EXPECT_FALSE(Find({.name = "held", .chains = {}}));
  EXPECT_FALSE(Find({.name = "free", .chains = {}, .support = {}, .free_root = true}));
}

// A shank turns about the ball at its end, so that its markers move by 0.1 m and more.
TEST_F(SupportCheck, AShankMayTurnAboutItsBall) {
  const Eigen::Vector3d origin = robot_.biped.tree.links[robot_.left].T_body_link.translation();
  const Eigen::Vector3d place(1.0, 2.0, 0.02);
  const auto turn_about = [&](const Eigen::Vector3d& ball, double slip) {
    for (int m = 0; m < robot_.model.marker_count(); ++m) {
      const Marker& marker = robot_.model.markers[m];
      if (!marker.name.starts_with("LFOOT")) continue;
      const Eigen::Vector3d on_body =
          robot_.biped.tree.links[marker.link].T_body_link * marker.p_link_marker;
      for (Eigen::Index i = 0; i < swinging_.positions.rows(); ++i) {
        const double share = static_cast<double>(i) / 400.0;
        const Eigen::Matrix3d R = (RotX(0.5 * share) * RotY(0.8 * share * share)).linear();
        swinging_.positions.row(i).segment<3>(3 * m) =
            (place + Eigen::Vector3d(slip * share, 0, 0) + R * (on_body - ball)).transpose();
      }
    }
  };
  // A trial with three standing feet assumes balls; this robot has only two.
  const Trial on_balls = {
      .name = "balls", .chains = {}, .support = {robot_.left, robot_.left, robot_.left}};
  turn_about(0.9 * origin, 0.0);
  EXPECT_FALSE(Find(on_balls));
  EXPECT_TRUE(Find({.name = "flat", .chains = {}, .support = {robot_.left}}));
  turn_about(0.9 * origin, 0.3);
  ASSERT_TRUE(Find(on_balls));
  EXPECT_GT(Find(on_balls)->distance, 0.05);
  // A shank that swings about its knee does not stand.
  turn_about(origin + Eigen::Vector3d(0.0, 0.0, 0.3), 0.0);
  EXPECT_TRUE(Find(on_balls));
}

}  // namespace
}  // namespace elastocal
