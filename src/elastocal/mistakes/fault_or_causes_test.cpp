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

}  // namespace
}  // namespace elastocal
