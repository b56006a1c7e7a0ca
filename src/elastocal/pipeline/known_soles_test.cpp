// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/known_soles.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/io/calibration_file.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

TEST(KnownSoles, AreThoseOfAnEarlierCalibrationWhereNoTrialTellsThem) {
  const StandingBiped robot;
  CalibrationResult result;
  result.model = robot.model;
  const int parameters = robot.model.parameter_count();
  result.delta.setZero(parameters);
  result.sd.setConstant(parameters, NAN);
  result.status.assign(static_cast<std::size_t>(parameters), ParameterStatus::kHeld);
  const ScratchFolder scratch;
  const auto file = scratch.Write(
      "calibration.yaml",
      MakeCalibrationYaml(
          result, "before", ZeroOffsets::kOrigin,
          {.soles = {{.leg = "left", .changes = 2, .compliance = 8e-7, .sd = 5e-8},
                     {.leg = "right", .changes = 1, .compliance = 1e-7, .sd = 1e-7}}}));
  Project project;
  project.tree = robot.biped.tree;
  const Measurements nothing;
  const std::vector<SoleSpring> alone = KnownSoles(project, result, nothing, {});
  ASSERT_EQ(alone.size(), 2u);
  EXPECT_TRUE(std::isinf(alone[0].sd));
  const std::vector<SoleSpring> soles = KnownSoles(project, result, nothing, file);
  EXPECT_EQ(soles[0].compliance, 8e-7);
  EXPECT_TRUE(soles[0].told());
  EXPECT_TRUE(std::isinf(soles[1].sd));  // the earlier calibration did not know it either
}

}  // namespace
}  // namespace elastocal
