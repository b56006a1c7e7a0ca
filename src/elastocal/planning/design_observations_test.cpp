// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/design_observations.hpp"

#include <string>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// A fixed arm whose tool a tracker sees; `hold`: patterns of parameters.
Project ArmThatHolds(const ScratchFolder& folder, const std::string& hold) {
  return ParseProject("robot: {urdf: " + SourceFile("tests/robots/arm6.urdf").string() +
                          "}\ninstruments:\n  trackers: [{name: laser}]\n"
                          "  poses: [{name: tool, link: tool, tracker: laser}]\n"
                          "recording: {not_recorded_mm: {finger_left_joint: 10}}\n"
                          "identifiability: {hold: [" +
                          hold + "]}\n",
                      (folder.path() / "project.yaml").string());
}

// Parameters that are held need no postures: these tell less, and are chosen for others.
TEST(ObservationDesign, IsForTheParametersThatAreNotHeld) {
  const ScratchFolder folder;
  const ObservationDesignOptions options{.count = 6, .candidates = 4};
  const auto design = [&](const std::string& hold) {
    return DesignObservations(ArmThatHolds(folder, hold), options);
  };
  const ObservationDesign all = design("");
  const ObservationDesign few = design("elbow_joint.*, shoulder_joint.*, turret_joint.*");
  ASSERT_TRUE(all.infeasible.empty()) << all.infeasible;
  ASSERT_TRUE(few.infeasible.empty()) << few.infeasible;
  EXPECT_LT(few.information, 0.9 * all.information);  // three joints of seven less: far below
  EXPECT_NE(few.postures[0].q, all.postures[0].q);
  ExpectInputError([&] { design("elbow_joint.thet"); },
                   {"identifiability.hold", "did you mean 'elbow_joint.theta'?"});
}

}  // namespace
}  // namespace elastocal
