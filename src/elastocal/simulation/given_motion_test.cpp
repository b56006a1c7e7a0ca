// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/given_motion.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/biped.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

class GivenMotion : public testing::Test {
 protected:
  /// A motion that gives trunk and left knee at each sample, and no other joint.
  JointMotion Samples(const std::vector<double>& trunk, const std::vector<double>& knee) const {
    JointMotion motion;
    motion.source = "m.csv";
    const auto rows = static_cast<Eigen::Index>(trunk.size());
    motion.q.setConstant(rows, biped_.tree.coordinate_count(),
                         std::numeric_limits<double>::quiet_NaN());
    motion.q.col(Coordinate("trunk_yaw")) = Eigen::Map<const Eigen::VectorXd>(trunk.data(), rows);
    motion.q.col(Coordinate("left_4")) = Eigen::Map<const Eigen::VectorXd>(knee.data(), rows);
    for (int i = 0; i < rows; ++i) motion.line.push_back(i + 2);
    return motion;
  }
  int Coordinate(const std::string& joint) const {
    return biped_.tree.joints[FindJoint(biped_.tree, joint)].coordinate;
  }
  std::vector<PlannedTrial> Plan(const JointMotion& motion, const GivenMotionOptions& given = {}) {
    return PlanGivenMotion(biped_.tree, biped_.chains, motion, {}, given);
  }

  const Biped biped_ = MakeBiped();
  const int left_ = FindLink(biped_.tree, "left_sole");
  const int right_ = FindLink(biped_.tree, "right_sole");
};

TEST_F(GivenMotion, PosturesAreVisitedFiveSecondsApart) {
  JointMotion motion = Samples({0.1, 0.2, -0.3}, {0.5, 0.5, 0.5});
  const std::vector<PlannedTrial> trials = Plan(motion, {.name = "mine"});
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_EQ(trials[0].name, "mine");
  EXPECT_EQ(trials[0].kind, TrialKind::kCalibration);
  EXPECT_EQ(trials[0].support, (std::vector<int>{left_, right_}));
  EXPECT_EQ(trials[0].chains, std::vector<int>{0});  // the trunk alone moves
  EXPECT_EQ(trials[0].postures, 3);
  // The robot rests for 5 s of lead-in and 1.5 s. Each further posture takes a motion of 3.5 s and
  // a rest of 1.5 s.
  EXPECT_DOUBLE_EQ(trials[0].motion.duration_s(), 6.5 + 2 * 5.0);
  const int yaw = Coordinate("trunk_yaw");
  EXPECT_DOUBLE_EQ(PostureAt(trials[0].motion, 6.4)[yaw], 0.1);
  EXPECT_NEAR(PostureAt(trials[0].motion, 6.5 + 1.75)[yaw], 0.15, 1e-12);  // half way
  EXPECT_DOUBLE_EQ(PostureAt(trials[0].motion, 11.0)[yaw], 0.2);
  EXPECT_DOUBLE_EQ(PostureAt(trials[0].motion, 16.5)[yaw], -0.3);
  EXPECT_NE(PostureAt(trials[0].motion, 0.0)[Coordinate("right_4")],
            0.0);  // stands with bent knees
}

TEST_F(GivenMotion, ATrajectoryIsFollowedWithItsRests) {
  // The robot rests for a second and then follows a parabola, which cubic interpolation meets
  // exactly.
  JointMotion motion = Samples({0, 0, 0.04, 0.16, 0.36}, {0.5, 0.5, 0.5, 0.5, 0.5});
  motion.time_s.resize(5);
  motion.time_s << 10.0, 11.0, 11.2, 11.4, 11.6;
  const std::vector<PlannedTrial> trials = Plan(motion);
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_EQ(trials[0].postures, 1);
  EXPECT_DOUBLE_EQ(trials[0].motion.duration_s(), 5.0 + 1.6 + 1.5);
  const int yaw = Coordinate("trunk_yaw");
  EXPECT_EQ(PostureAt(trials[0].motion, 5.9)[yaw], 0.0);
  EXPECT_NEAR(PostureAt(trials[0].motion, 6.2)[yaw], 0.04, 1e-12);
  EXPECT_NEAR(PostureAt(trials[0].motion, 6.3)[yaw], 0.09, 1e-12);  // (0.3 s)^2 x 1 rad/s^2
  EXPECT_NEAR(PostureAt(trials[0].motion, 6.6)[yaw], 0.36, 1e-12);
  EXPECT_EQ(PostureAt(trials[0].motion, 8.0)[yaw], 0.36);
}

TEST_F(GivenMotion, WithoutRestsItJudgesAndAKindThatIsGivenHolds) {
  JointMotion motion = Samples({0, 0.1, 0.2}, {0.5, 0.5, 0.5});
  motion.time_s = Eigen::Vector3d(0.0, 0.2, 0.4);
  EXPECT_EQ(Plan(motion)[0].kind, TrialKind::kSine);
  const GivenMotionOptions given{.kind = TrialKind::kRandom, .chains = {2}};
  EXPECT_EQ(Plan(motion, given)[0].kind, TrialKind::kRandom);
  EXPECT_EQ(Plan(motion, given)[0].chains, std::vector<int>{2});
}

TEST_F(GivenMotion, EachStretchOfOneSupportIsATrial) {
  JointMotion motion = Samples({0.0, 0.1, 0.1, 0.1, 0.2}, {0.5, 0.5, 0.6, 0.8, 0.8});
  motion.support = {{left_, right_}, {left_, right_}, {right_}, {right_}, {right_}};
  const std::vector<PlannedTrial> trials = Plan(motion);
  ASSERT_EQ(trials.size(), 2u);
  EXPECT_EQ(trials[0].name, "motion_1");
  EXPECT_EQ(trials[0].chains, std::vector<int>{0});
  EXPECT_EQ(trials[1].name, "motion_2");
  EXPECT_EQ(trials[1].support, std::vector<int>{right_});
  EXPECT_EQ(trials[1].chains, (std::vector<int>{0, 1}));  // trunk and left leg
  EXPECT_EQ(trials[1].postures, 3);
}

TEST_F(GivenMotion, AFootThatStandsThroughTwoTrialsStays) {
  // The robot stands on both feet, on the right one, on the left one, and on both.
  JointMotion motion = Samples({0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}, std::vector(8, 0.5));
  motion.support = {{left_, right_}, {left_, right_}, {right_},        {right_},
                    {left_},         {left_},         {left_, right_}, {left_, right_}};
  EXPECT_FALSE(Plan(motion)[1].stays);  // postures without times are no trajectory
  motion.time_s = Eigen::VectorXd::LinSpaced(8, 0.0, 1.4);
  std::vector<PlannedTrial> trials = Plan(motion);
  ASSERT_EQ(trials.size(), 4u);
  EXPECT_EQ(trials[0].support, (std::vector<int>{right_, left_}));
  EXPECT_EQ(trials[1].support, std::vector<int>{right_});
  EXPECT_EQ(trials[3].support, (std::vector<int>{left_, right_}));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(trials[i].stays, i == 1 || i == 3) << i;

  // The robot stands on one foot, on both, and on the other. The second foot need not stay beside
  // the first.
  motion.support = {{right_}, {right_}, {left_, right_}, {left_, right_},
                    {left_},  {left_},  {right_},        {right_}};
  trials = Plan(motion);
  EXPECT_EQ(trials[1].support, (std::vector<int>{right_, left_}));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(trials[i].stays, i == 1) << i;
}

TEST_F(GivenMotion, AStretchInWhichOnlyWhatStandsMovesIsPassedOver) {
  JointMotion motion = Samples({0.1, 0.1, 0.1, 0.1}, {0.5, 0.5, 0.6, 0.8});
  motion.support = {{left_, right_}, {left_, right_}, {right_}, {right_}};
  const std::vector<PlannedTrial> trials = Plan(motion);
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_EQ(trials[0].support, std::vector<int>{right_});
  EXPECT_EQ(trials[0].postures, 2);
}

TEST_F(GivenMotion, ARoundingExercisesNoChain) {
  // The positions were written with nine digits and with sixteen.
  JointMotion motion = Samples({0.1, 0.1 + 3e-9, 0.1}, {0.5, 0.6, 0.8});
  motion.support = {{right_}, {right_}, {right_}};
  EXPECT_EQ(Plan(motion)[0].chains, std::vector<int>{1});  // the left leg, not the trunk
}

TEST_F(GivenMotion, RefusesWhatCannotBePlayed) {
  const JointMotion knee = Samples({0, 0, 0}, {0.5, 0.5, 0.8});
  ExpectInputError([&] { Plan(knee); },
                   {"m.csv:4: ", "'right_sole'", "both cannot be on the floor"});
  const JointMotion still = Samples({0.1, 0.1}, {0.5, 0.5});
  ExpectInputError([&] { Plan(still); }, {"m.csv:2: ", "no chain of the project moves"});
  JointMotion lonely = Samples({0.0, 0.1, 0.2}, {0.5, 0.5, 0.5});
  lonely.time_s = Eigen::Vector3d(0.0, 1.0, 2.0);
  lonely.support = {{left_}, {left_}, {right_}};
  ExpectInputError([&] { Plan(lonely, {.chains = {0}}); }, {"m.csv:4: ", "one sample alone"});
}

}  // namespace
}  // namespace elastocal
