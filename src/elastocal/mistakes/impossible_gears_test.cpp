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

// The rail's column is too long by 2 %, or the cameras' scale is too small by 2 %. The other
// lengths say so too, but only if they say it together.
TEST(ScaleOfSlides, IsNoneWhereOneLengthMakesTheScale) {
  const Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  const auto coordinate = [&](const char* joint) {
    return project.tree.joints[static_cast<std::size_t>(FindJoint(project.tree, joint))].coordinate;
  };
  const RecordingFault rail{.coordinate = coordinate("rail_joint"), .size = 0.02, .sd = 1e-3};
  CommonScale scale{.size = -0.02, .sd = 4e-3, .degrees_of_freedom = 9.0};
  const std::string both = ScaleOfSlides({rail}, project.tree, scale);
  EXPECT_EQ(both.find("the cameras' positions seem 0.98"), 0u) << both;
  EXPECT_NE(both.find("--accept gain:rail_joint=1.02"), std::string::npos) << both;
  scale.of_one_length = true;
  EXPECT_EQ(ScaleOfSlides({rail}, project.tree, scale), "");
  scale = {.size = 0.02, .sd = 4e-3, .degrees_of_freedom = 9.0};  // they say the opposite
  EXPECT_EQ(ScaleOfSlides({rail}, project.tree, scale), "");
  EXPECT_EQ(ScaleOfSlides({rail}, project.tree, std::nullopt), "");
  const RecordingFault elbow{.coordinate = coordinate("elbow_joint"), .size = 0.02, .sd = 1e-3};
  scale = {.size = -0.02, .sd = 4e-3, .degrees_of_freedom = 9.0};
  EXPECT_EQ(ScaleOfSlides({elbow}, project.tree, scale), "");
}

}  // namespace
}  // namespace elastocal
