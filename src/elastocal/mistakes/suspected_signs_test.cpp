// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/suspected_signs.hpp"

#include <gtest/gtest.h>

#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

std::vector<int> Coordinates(const std::vector<LogSuspicion>& signs, int postures) {
  std::vector<int> coordinates;
  for (const LogSuspicion& one : signs) {
    EXPECT_EQ(one.kind, LogContradiction::kSign);
    EXPECT_EQ(static_cast<int>(one.postures.size()), postures);
    coordinates.push_back(one.coordinate);
  }
  return coordinates;
}

Recording Moving(int postures, int joints) {
  Recording recording;
  recording.q = Eigen::VectorXd::LinSpaced(postures, -1.0, 1.0).replicate(1, joints);
  return recording;
}

CalibrationResult Nominal() {
  CalibrationResult result;
  result.model = TalosLegModel();
  result.delta.setZero(result.model.parameter_count());
  return result;
}

TEST(SuspectedSigns, AllJointsThatMove) {
  Recording recording = Moving(5, 6);
  recording.q.col(2).setConstant(0.3);
  const auto signs = AllSigns(TalosLeg(), recording);
  EXPECT_EQ(Coordinates(signs, 5), (std::vector<int>{0, 1, 3, 4, 5}));
}

// Each sign needs a fit, and a humanoid has 30 joints.
TEST(SuspectedSigns, NoneOfManyJoints) {
  RobotTree tree = MakeRoot();
  int link = 0;
  for (int k = 0; k < 13; ++k) {
    link = AddJoint(tree, "j" + std::to_string(k), link, Offset(0.1, 0, 0), {0, 0, 1});
  }
  Recording recording = Moving(5, 13);
  EXPECT_TRUE(AllSigns(tree, recording).empty());
  recording.q.col(0).setZero();
  EXPECT_EQ(AllSigns(tree, recording).size(), 12u);
}

// Reversing either joint explains what the markers show.
TEST(SuspectedSigns, OfATurnedAxisAndOfTheJointBefore) {
  CalibrationResult result = Nominal();
  const Recording recording = Moving(4, 6);
  EXPECT_TRUE(SignsOfTurnedAxes(result, recording).empty());
  result.delta[FindParameter(result.model.parameters, "leg_4.alpha")] = 3.1;
  EXPECT_EQ(Coordinates(SignsOfTurnedAxes(result, recording), 4), (std::vector<int>{3, 2}));
  result.delta[FindParameter(result.model.parameters, "leg_5.alpha")] = -1.6;
  EXPECT_EQ(Coordinates(SignsOfTurnedAxes(result, recording), 4), (std::vector<int>{3, 2, 4}));
}

TEST(SuspectedSigns, OfTheFirstJointAlone) {
  CalibrationResult result = Nominal();
  result.delta[FindParameter(result.model.parameters, "leg_1.alpha")] = 3.1;
  EXPECT_EQ(Coordinates(SignsOfTurnedAxes(result, Moving(4, 6)), 4), std::vector<int>{0});
}

}  // namespace
}  // namespace elastocal
