// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/motions.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"
#include "tests/biped.hpp"

namespace elastocal {
namespace {

MotionOptions FewPostures() {
  MotionOptions options;
  options.head_postures = options.leg_postures = 4;
  options.random_postures = 3;
  return options;
}

TEST(PlanTrials, AreThoseOfThePaper) {
  const Biped biped = MakeBiped();
  const auto trials = PlanTrials(biped.tree, biped.chains, FewPostures());
  std::vector<std::string> names;
  for (const PlannedTrial& trial : trials) names.push_back(trial.name);
  EXPECT_EQ(names,
            (std::vector<std::string>{"trunk", "left", "right", "upper_sine", "upper_random",
                                      "upper_repeat", "left_sine", "left_random", "left_repeat",
                                      "right_sine", "right_random", "right_repeat"}));
  const int left = FindLink(biped.tree, "left_sole");
  const int right = FindLink(biped.tree, "right_sole");
  EXPECT_EQ(trials[0].support, (std::vector<int>{left, right}));
  EXPECT_EQ(trials[1].support, std::vector<int>{right});
  EXPECT_EQ(trials[2].support, std::vector<int>{left});
  EXPECT_EQ(trials[1].chains, std::vector<int>{1});
  EXPECT_EQ(trials[1].kind, TrialKind::kCalibration);
  EXPECT_EQ(trials[6].kind, TrialKind::kSine);
  // After the lead-in, each posture takes five seconds.
  EXPECT_DOUBLE_EQ(trials[1].motion.duration_s(), 5.0 + 4 * 5.0);
  EXPECT_DOUBLE_EQ(trials[5].motion.duration_s(), 5.0 + 10 * 5.0);
}

TEST(PlanTrials, MotionsAreSmoothAndWithinTheLimits) {
  const Biped biped = MakeBiped();
  for (const PlannedTrial& trial : PlanTrials(biped.tree, biped.chains, FewPostures())) {
    constexpr double kStep = 0.01;
    Eigen::VectorXd before = PostureAt(trial.motion, 0.0);
    Eigen::VectorXd speed_before = Eigen::VectorXd::Zero(before.size());
    const int steps = static_cast<int>((trial.motion.duration_s() + 0.1) / kStep);
    for (int step = 1; step <= steps; ++step) {
      const double t = kStep * step;
      const Eigen::VectorXd q = PostureAt(trial.motion, t);
      const Eigen::VectorXd speed = (q - before) / kStep;
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const JointLimits& limits = biped.tree.joints[static_cast<std::size_t>(i)].limits;
        ASSERT_GE(q[i], limits.lower - 1e-9) << trial.name;
        ASSERT_LE(q[i], limits.upper + 1e-9) << trial.name;
        ASSERT_LE(std::abs(speed[i]), limits.velocity) << trial.name;
        // Speeds do not jump: accelerations of a few rad/s^2 change them by hundredths within 0.01
        // s.
        ASSERT_LE(std::abs(speed[i] - speed_before[i]), 0.3) << trial.name << " at " << t;
      }
      before = q;
      speed_before = speed;
    }
    EXPECT_TRUE(speed_before.isZero()) << trial.name;
  }
}

TEST(PlanTrials, SwingAboveTheFloorOnABentLegThatCarries) {
  const Biped biped = MakeBiped();
  const std::vector<Leg> legs = FindLegs(biped.tree, biped.chains);
  const MotionOptions options = FewPostures();
  std::vector<double> knees;
  for (const PlannedTrial& trial : PlanTrials(biped.tree, biped.chains, options)) {
    if (trial.name != "left" && trial.name != "left_random") continue;
    for (const MotionSegment& segment : trial.motion.segments) {
      const auto T = LinkTransforms(biped.tree, segment.to);
      const Transform T_sole_waist = T[static_cast<std::size_t>(legs[1].foot_link)].inverse();
      const Transform& T_waist_swing = T[static_cast<std::size_t>(legs[0].foot_link)];
      EXPECT_GE((T_sole_waist * T_waist_swing).translation().z(),
                options.postures.ground_clearance);
      // The workspace of Fig. 2 is for a robot of 1.082 m.
      const Eigen::Vector3d p = T_waist_swing.translation() * 1.083 / 1.082;
      EXPECT_TRUE((p.array() >= options.postures.foot.lower.array()).all()) << p.transpose();
      EXPECT_TRUE((p.array() <= options.postures.foot.upper.array()).all()) << p.transpose();
      // The centre of mass is over the sole.
      const Eigen::Vector3d com =
          T_sole_waist * CentreOfMass(biped.tree, BodyInertias(biped.tree), segment.to);
      EXPECT_LE(std::abs(com.x()), options.postures.sway.x() + 0.01);
      EXPECT_LE(std::abs(com.y()), options.postures.sway.y() + 0.01);
      const double knee = segment.to[FindJoint(biped.tree, "right_4")];
      EXPECT_GE(knee, options.postures.least_bend);
      EXPECT_LE(knee, options.postures.largest_bend);
      knees.push_back(knee);
    }
  }
  ASSERT_GE(knees.size(), 10u);
  const auto [least, most] = std::minmax_element(knees.begin(), knees.end());
  EXPECT_GT(*most - *least, 0.2) << "the leg that carries must vary";
}

TEST(PlanTrials, DependOnTheSeedAlone) {
  const Biped biped = MakeBiped();
  MotionOptions options = FewPostures();
  const auto first = PlanTrials(biped.tree, biped.chains, options);
  const auto again = PlanTrials(biped.tree, biped.chains, options);
  options.seed = 2;
  const auto other = PlanTrials(biped.tree, biped.chains, options);
  EXPECT_EQ(first[1].motion.segments[1].to, again[1].motion.segments[1].to);
  EXPECT_NE(first[1].motion.segments[1].to, other[1].motion.segments[1].to);
}

TEST(PlaceFoot, PutsTheFootWhereItIsTold) {
  const Biped biped = MakeBiped();
  const std::vector<Leg> legs = FindLegs(biped.tree, biped.chains);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(biped.tree.coordinate_count());
  q.segment<6>(2) << 0.0, 0.0, -0.3, 0.6, -0.3, 0.0;
  const Transform wanted = FromXyzRpy({0.05, 0.12, -0.98}, {0.05, -0.1, 0.15});
  const auto placed = PlaceFoot(biped.tree, legs[0], wanted, q);
  ASSERT_TRUE(placed);
  const Transform found =
      LinkTransforms(biped.tree, *placed)[static_cast<std::size_t>(legs[0].foot_link)];
  EXPECT_LT((found.matrix() - wanted.matrix()).cwiseAbs().maxCoeff(), 1e-7);
  EXPECT_FALSE(PlaceFoot(biped.tree, legs[0], Offset(0, 0.1, -1.5), q)) << "out of reach";
}

TEST(PostureAt, HoldsBeforeAndAfter) {
  const Eigen::VectorXd a = Eigen::VectorXd::Zero(1);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(1);
  const Motion motion{{{.duration_s = 2.0, .from = a, .to = b}}};
  EXPECT_EQ(PostureAt(motion, -1.0)[0], 0.0);
  EXPECT_EQ(PostureAt(motion, 1.0)[0], 0.5);
  EXPECT_EQ(PostureAt(motion, 5.0)[0], 1.0);
}

}  // namespace
}  // namespace elastocal
