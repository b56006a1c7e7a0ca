// SPDX-License-Identifier: Apache-2.0
// Recordings of two arms that only markers on the tool show: a held root link stands in for markers
// on it.

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/mistakes/recordings_apart.hpp"
#include "elastocal/mistakes/trials_apart.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "tests/invented_arm.hpp"

namespace elastocal {
namespace {

class ArmsApart : public InventedArm {
 protected:
  static constexpr double kMarkerSd = 2e-4;

  void SetUp() override {
    InventedArm::SetUp();
    model_ = SelectMarkers(model_, {"TOOL_1", "TOOL_2", "TOOL_3"});
    base_ = FindBaseParameters(model_, {});
  }

  Recording Record(int robot, int session) const {
    Recording recording = MakeSyntheticRecording(
        model_, Truth(robot),
        {.postures = 40, .marker_sd = kMarkerSd, .seed = 1 + static_cast<std::uint64_t>(session)});
    recording.trials = {{session == 0 ? "monday/arm" : "friday/arm",
                         TrialKind::kCalibration,
                         {project_.chains.front().name}}};
    recording.trials[0].session = session;
    recording.trial.assign(40, 0);
    return recording;
  }

  double Alone(const Recording& recording) const {
    return ErrorAlone({model_, base_}, recording, ModelKind::kGeometric, {});
  }

  std::string Said(int second) const {
    const Recording both = JoinTrials(Record(1, 0), Record(second, 1));
    const CalibrationResult fit = Calibrate(model_, both, base_, ModelKind::kGeometric, {});
    const auto apart = FindRecordingsApart(project_, {model_, base_}, both, fit,
                                           std::numeric_limits<double>::infinity());
    return apart ? apart->said : "";
  }

  const Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
};

// 40 postures tell 240 numbers of a pose each; noise of the markers is all that is left. Errors of
// a 3-D rms of sqrt(3) sd scatter by a tenth.
TEST_F(ArmsApart, ErrorByItselfIsThatOfTheMarkers) {
  EXPECT_NEAR(Alone(Record(1, 0)), std::sqrt(3.0) * kMarkerSd, 0.3 * std::sqrt(3.0) * kMarkerSd);
  Recording table = Record(1, 0);
  table.trials.clear();
  table.trial.clear();
  EXPECT_NEAR(Alone(table), std::sqrt(3.0) * kMarkerSd, 0.3 * std::sqrt(3.0) * kMarkerSd);
}

TEST_F(ArmsApart, TwoArmsAreNotOne) {
  EXPECT_EQ(Said(1), "");
  const std::string said = Said(2);
  EXPECT_EQ(said.find("the recordings are not of one robot in one state"), 0u) << said;
}

}  // namespace
}  // namespace elastocal
