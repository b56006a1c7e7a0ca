// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/camera_scale.hpp"

#include <map>

#include <gtest/gtest.h>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/talos_left_arm.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

// Twenty lengths and more (kManyLengths). An arm that is made to 0.2 mm shows a scale of 0.6 %,
// which one with errors of 1 mm may have.
TEST(CameraScale, IsToldTheBetterTheMoreExactlyTheArmIsMade) {
  constexpr int kRobots = 10;
  const Project project = ParseProject(kTalosLeftArm, SourceFile("project.yaml"));
  const ErrorModel model = MakeProjectModel(project, {});
  const BaseParameters base = FindBaseParameters(model, project.identifiability);
  for (const double length_sd : {0.2e-3, 1e-3}) {
    int found = 0, accused = 0;
    for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
      const std::map<ParameterKind, double> errors = {{ParameterKind::kTheta, 0.01},
                                                      {ParameterKind::kR, length_sd},
                                                      {ParameterKind::kD, length_sd},
                                                      {ParameterKind::kB, length_sd}};
      Recording recording = MakeSyntheticRecording(
          model, DrawErrors(model, base.kept, errors, seed), {.postures = 40, .seed = seed});
      const auto wrong = [&] {
        return FindWrongScale(
            Calibrate(model, recording, base, ModelKind::kGeometric, project.calibration),
            project.calibration);
      };
      accused += wrong() ? 1 : 0;
      recording.markers *= 1.006;
      found += wrong() ? 1 : 0;
    }
    EXPECT_EQ(accused, 0) << length_sd;
    EXPECT_TRUE(length_sd > 0.5e-3 ? found < 4 : found >= 8) << length_sd << ": " << found;
  }
}

}  // namespace
}  // namespace elastocal
