// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/impossible_gears.hpp"

#include <gtest/gtest.h>

#include "elastocal/project/project.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// Number of impossible gears where this cause is estimated at `ratio`.
std::size_t ImpossibleAt(const std::string& cause, double ratio, double sd) {
  Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  project.elasticity.extra = {cause};
  CalibrationResult result;
  result.model = MakeProjectModel(project, {});
  result.delta = Eigen::VectorXd::Zero(result.model.parameter_count());
  result.sd = Eigen::VectorXd::Constant(result.model.parameter_count(), sd);
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    if (result.model.parameters[static_cast<std::size_t>(i)].correction >= 0) {
      result.delta[i] = ratio;
    }
  }
  return FindImpossibleGears(result).size();
}

// Leads are typically off by 0.3 %.
TEST(ImpossibleGears, ALeadThatARobotMayHaveIsNone) {
  EXPECT_EQ(ImpossibleAt("rail_joint.gear", 0.004, 1e-4), 0u);
  EXPECT_EQ(ImpossibleAt("rail_joint.gear", -0.004, 1e-4), 0u);
  EXPECT_EQ(ImpossibleAt("rail_joint.gear", 0.006, 1e-4), 1u);
}

TEST(ImpossibleGears, AreFiveStandardDeviationsBeyondAHalfPercent) {
  EXPECT_EQ(ImpossibleAt("elbow_joint.gear", 0.009, 1e-3), 0u);
  EXPECT_EQ(ImpossibleAt("elbow_joint.gear", 0.011, 1e-3), 1u);
}

}  // namespace
}  // namespace elastocal
