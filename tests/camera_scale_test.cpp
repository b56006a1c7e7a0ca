// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/camera_scale.hpp"

#include <map>

#include <gtest/gtest.h>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/talos_left_arm.hpp"
#include "tests/test_files.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// An arm that is made with errors of `exact` reveals a scale error of 0.6 %. One with errors of 1
/// mm may have that scale, too.
void ExpectThatAnExactArmTells(const ErrorModel& model, const BaseParameters& base,
                               const CalibrationOptions& options, double exact) {
  constexpr int kRobots = 10;
  for (const double length_sd : {exact, 1e-3}) {
    int found = 0, accused = 0;
    for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
      const std::map<ParameterKind, double> errors = {{ParameterKind::kTheta, 0.01},
                                                      {ParameterKind::kR, length_sd},
                                                      {ParameterKind::kD, length_sd},
                                                      {ParameterKind::kB, length_sd}};
      Recording recording = MakeSyntheticRecording(
          model, DrawErrors(model, base.kept, errors, seed), {.postures = 40, .seed = seed});
      const auto wrong = [&] {
        return FindWrongScale(Calibrate(model, recording, base, ModelKind::kGeometric, options),
                              options);
      };
      accused += wrong() ? 1 : 0;
      recording.markers *= 1.006;
      found += wrong() ? 1 : 0;
    }
    EXPECT_EQ(accused, 0) << length_sd;
    EXPECT_TRUE(length_sd == exact ? found >= 8 : found < 4) << length_sd << ": " << found;
  }
}

// The arm has at least twenty lengths (kManyLengths).
TEST(CameraScale, IsToldTheBetterTheMoreExactlyTheArmIsMade) {
  const Project project = ParseProject(kTalosLeftArm, SourceFile("project.yaml"));
  const ErrorModel model = MakeProjectModel(project, {});
  ExpectThatAnExactArmTells(model, FindBaseParameters(model, project.identifiability),
                            project.calibration, 0.2e-3);
}

/// Seven joints with axes at right angles, like common arms.
ErrorModel SevenJointArm() {
  using Eigen::Vector3d;
  const Vector3d y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  RobotTree tree = MakeRoot();
  AddJoint(tree, "arm_1", 0, Offset(0, 0, 0.34), z);
  AddJoint(tree, "arm_2", 1, Transform::Identity(), y);
  AddJoint(tree, "arm_3", 2, Offset(0, 0, 0.32), z);
  AddJoint(tree, "arm_4", 3, Offset(0.08, 0, 0), y);
  AddJoint(tree, "arm_5", 4, Offset(-0.08, 0, 0.38), z);
  AddJoint(tree, "arm_6", 5, Transform::Identity(), y);
  AddJoint(tree, "arm_7", 6, Offset(0.09, 0, 0), z);
  return MakeErrorModel(tree, {{"HAND_1", 7, {0.05, 0.04, 0.11}},
                               {"HAND_2", 7, {-0.06, 0.03, 0.15}},
                               {"HAND_3", 7, {0.02, -0.07, 0.19}}});
}

// The recording determines between eight and nineteen lengths (kNarrowestOfSome).
TEST(CameraScale, IsToldByAnArmOfFewLengths) {
  const ErrorModel model = SevenJointArm();
  ExpectThatAnExactArmTells(model, FindBaseParameters(model, {}), {}, 0.1e-3);
}

}  // namespace
}  // namespace elastocal
