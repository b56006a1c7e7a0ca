// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/fault_or_causes.hpp"

#include <gtest/gtest.h>

#include "elastocal/project/project.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

// Springs that the data did not choose explain no fault away.
TEST(FaultOrCauses, WhatTheProjectStatesHidesNoFault) {
  using Patterns = std::vector<std::string>;
  Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  EXPECT_FALSE(MayHideFault(project, false));
  project.elasticity.torsion = Patterns();
  project.elasticity.bending = Patterns{"*"};
  EXPECT_FALSE(MayHideFault(project, false));
  EXPECT_TRUE(MayHideFault(project, true));
  project.elasticity.torsion = Patterns{"*"};
  project.elasticity.bending = Patterns();
  EXPECT_FALSE(MayHideFault(project, true));
}

// Springs of all joints may explain more than what the data chose. Then not the faults beside them
// explain the recording.
TEST(FaultOrCauses, FaultsHaveToExplainWhatThePlainFitLeaves) {
  EXPECT_TRUE(ExplainPlainFit(0.79e-3, 1e-3));
  EXPECT_FALSE(ExplainPlainFit(0.81e-3, 1e-3));
}

// Bending has two numbers for each joint that springs about the axes do not have.
TEST(FaultOrCauses, FewFaultsLeaveFarLessThanCausesOrLessThanBendingJoints) {
  EXPECT_TRUE(LeaveLess(0.79e-3, 1e-3, false));
  EXPECT_FALSE(LeaveLess(0.81e-3, 1e-3, false));
  EXPECT_TRUE(LeaveLess(0.99e-3, 1e-3, true));
  EXPECT_FALSE(LeaveLess(1.01e-3, 1e-3, true));
}

}  // namespace
}  // namespace elastocal
