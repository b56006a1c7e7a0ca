// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/sole_springs.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

constexpr int kPosturesEach = 4;

/// The biped stands on its left foot (1), on both feet (2) or on its right foot (0), trial by
/// trial.
class SoleSprings : public testing::Test {
 protected:
  SoleSprings() { result_.model = robot_.model; }

  Recording Stand(const std::vector<int>& feet) {
    std::vector<Trial> trials;
    for (int n : feet) {
      trials.push_back({.name = "trial", .chains = {}});
      if (n > 0) trials.back().support.push_back(robot_.left);
      if (n != 1) trials.back().support.push_back(robot_.right);
    }
    result_.delta.setZero(robot_.model.parameter_count());
    Recording recording = robot_.Empty(std::move(trials), kPosturesEach);
    for (int t = 0; t < static_cast<int>(feet.size()); ++t) {
      Put("LFOOT", t, Transform::Identity(), recording);
      Put("RFOOT", t, Transform::Identity(), recording);
    }
    return recording;
  }

  /// Places the markers of a foot so that they show this pose in all postures of a trial.
  void Put(const std::string& cluster, int trial, const Transform& T_ref_foot,
           Recording& recording) const {
    for (int m = 0; m < robot_.model.marker_count(); ++m) {
      const Marker& marker = robot_.model.markers[static_cast<std::size_t>(m)];
      if (!marker.name.starts_with(cluster)) continue;
      for (int i = 0; i < kPosturesEach; ++i) {
        recording.markers.block<1, 3>(trial * kPosturesEach + i, 3 * m) =
            (T_ref_foot * marker.p_link_marker).transpose();
      }
    }
  }

  std::vector<SoleSpring> Estimate(const Recording& recording) const {
    std::vector<FootRest> rests = FindFootRests(robot_.biped.tree, robot_.biped.markers, recording);
    for (FootRest& rest : rests) {
      if (std::isnan(rest.share)) rest.share = share_on_two_;  // no torques were measured
    }
    return EstimateSoleSprings(result_, rests, -9.81 * up_);
  }

  SoleSpring Left(const Recording& recording) const { return Estimate(recording).front(); }

  static Transform At(double x, double y, double z, double heading = 0.0) {
    return Eigen::Translation3d(x, y, z) * RotZ(heading);
  }

  double share_on_two_ = 0.5;
  const Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();
  const StandingBiped robot_ = {};
  const double weight_ = 9.81 * TotalMass(robot_.biped.tree);
  CalibrationResult result_;
};

TEST_F(SoleSprings, HeightOverLoadOfAFootThatStays) {
  Recording recording = Stand({2, 1, 2});
  share_on_two_ = 0.6;
  const double on_two = 0.6 * weight_;
  Put("LFOOT", 0, At(0.0, 0.0, -1e-6 * on_two), recording);
  Put("LFOOT", 1, At(0.0, 3e-5, -1e-6 * weight_), recording);
  Put("LFOOT", 2, At(0.0, 0.0, -1e-6 * on_two), recording);
  const SoleSpring left = Left(recording);
  EXPECT_EQ(left.leg, "left");
  EXPECT_EQ(left.changes, 2);
  EXPECT_NEAR(left.compliance, 1e-6, 1e-12);
  // The left foot moved by 30 um along the floor once. Its two changes of load give 2 x 3
  // coordinates, less one for the estimate, hence 5 degrees of freedom. The right foot left the
  // floor and adds none.
  const double along = 3e-5 * std::sqrt(2.0 / 3.0);
  const double loads = std::sqrt(2.0 / 3.0) * (weight_ - on_two);
  EXPECT_NEAR(left.sd, std::hypot(along / std::sqrt(5.0) / loads, 0.05e-6), 1e-12);
  EXPECT_NEAR(left.interval_factor, StudentQuantile(0.975, 5.0), 1e-12);
  EXPECT_TRUE(left.told());
  const SoleSpring right = Estimate(recording).back();
  EXPECT_EQ(right.changes, 0);
  EXPECT_FALSE(right.told());
  EXPECT_TRUE(std::isinf(right.most()));
}

TEST_F(SoleSprings, ATiltCountsAtTheOriginOfTheLink) {
  Recording recording = Stand({2, 1});
  const Transform tilted = Eigen::Translation3d(0.0, 0.0, -2e-4) * RotX(2e-3);
  Put("LFOOT", 1, tilted, recording);
  EXPECT_NEAR(Left(recording).compliance, 2e-4 / (0.5 * weight_), 1e-10);
  share_on_two_ = NAN;  // without torques, the load of the foot before is unknown
  EXPECT_TRUE(std::isinf(Left(recording).sd));
}

TEST_F(SoleSprings, AFootThatIsSetDownAnewTellsNothing) {
  // The floor is half a millimetre lower at each of these places.
  for (const Transform& there : {At(0.5e-3, 0.0, -5e-4), At(0.0, 0.0, -5e-4, 8e-3)}) {
    Recording recording = Stand({2, 1});
    Put("LFOOT", 1, there, recording);
    EXPECT_TRUE(std::isinf(Left(recording).sd));
  }
  // The foot was lifted in between, or the trials were recorded on different days.
  Recording recording = Stand({2, 0, 1});
  Put("LFOOT", 2, At(0.0, 0.0, -5e-4), recording);
  EXPECT_TRUE(std::isinf(Left(recording).sd));
  recording = Stand({2, 1});
  recording.trials[1].session = 1;
  Put("LFOOT", 1, At(0.0, 0.0, -5e-4), recording);
  EXPECT_TRUE(std::isinf(Left(recording).sd));
}

TEST_F(SoleSprings, AKnockedMarkerTellsNothing) {
  Recording recording = Stand({2, 1});
  for (int i = kPosturesEach; i < 2 * kPosturesEach; ++i) {
    for (int m = 0; m < robot_.model.marker_count(); ++m) {
      if (robot_.model.markers[static_cast<std::size_t>(m)].name == "LFOOT_2") {
        recording.markers(i, 3 * m) -= 1e-3;
      }
    }
  }
  EXPECT_TRUE(std::isinf(Left(recording).sd));
}

TEST_F(SoleSprings, WhatDriftsAsMuchAsItSinksIsNotTold) {
  Recording recording = Stand({2, 1});
  Put("LFOOT", 1, At(2e-4, 0.0, -3e-4), recording);
  const SoleSpring left = Left(recording);
  EXPECT_GT(left.compliance, 0.0);
  EXPECT_FALSE(left.told());
  EXPECT_GT(left.most(), 2.0 * left.compliance);
  // Nor is a compliance told by a sole that rises under load, or by loads that hardly change.
  Put("LFOOT", 1, At(0.0, 1e-6, 3e-4), recording);
  EXPECT_FALSE(Left(recording).told());
  EXPECT_FALSE(Left(Stand({2, 2, 2})).told());
  Recording table = Stand({2, 1});
  table.trials.clear();
  table.trial.clear();
  EXPECT_TRUE(std::isinf(Left(table).sd));
}

}  // namespace
}  // namespace elastocal
