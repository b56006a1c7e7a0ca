// SPDX-License-Identifier: Apache-2.0
// What held-out trials tell about a fault in the trials of the estimate, and what they cannot tell.

#include <algorithm>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/mistakes/find_contradictions.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "elastocal/validation/held_out.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class HeldOutGain : public testing::Test {
 protected:
  static constexpr int kCoordinate = 2;
  static constexpr double kGain = 1.03;

  HeldOutGain() {
    truth_ = DrawErrors(model_, base_.kept, {{ParameterKind::kTheta, 0.01}}, 1);
    joint_ =
        project_.tree.joints[static_cast<std::size_t>(project_.tree.coordinate_joint[kCoordinate])]
            .name;
  }

  Recording AsTrial(const std::string& name, TrialKind kind, std::uint64_t seed,
                    int postures = 40) const {
    Recording recording =
        MakeSyntheticRecording(model_, truth_, {.postures = postures, .seed = seed});
    recording.trials = {{name, kind, {project_.chains.front().name}}};
    recording.trial.assign(static_cast<std::size_t>(postures), 0);
    return recording;
  }

  std::string Explained(const Recording& recording, const Recording& held_out) const {
    const CalibrationResult fit =
        Calibrate(model_, recording, base_, ModelKind::kGeometric, project_.calibration);
    const auto faults = FindRecordingFaults(fit, recording, project_.calibration);
    if (faults.empty()) return "";
    return ExplainFault({faults.front(), model_, base_, recording, ModelKind::kGeometric,
                         project_.calibration, held_out},
                        project_)
        .text;
  }

  Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  ErrorModel model_ = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  BaseParameters base_ = FindBaseParameters(model_, project_.identifiability);
  Eigen::VectorXd truth_;
  std::string joint_;
};

TEST_F(HeldOutGain, IsOneOfTheTrialsThatHaveIt) {
  Recording recording = AsTrial("swing", TrialKind::kCalibration, 1);
  Recording held_out = AsTrial("check", TrialKind::kRandom, 2);
  recording.q.col(kCoordinate) *= kGain;
  const std::string alone = Explained(recording, held_out);
  EXPECT_NE(alone.find("in trial swing (--accept gain:" + joint_ + "@swing=1.0"), std::string::npos)
      << alone;
  held_out.q.col(kCoordinate) *= kGain;
  const std::string all = Explained(recording, held_out);
  EXPECT_NE(all.find("(--accept gain:" + joint_ + "=1.0"), std::string::npos) << all;
  held_out.q.col(kCoordinate).setConstant(0.2);  // now they tell nothing about the gain
  EXPECT_NE(Explained(recording, held_out).find("(--accept gain:" + joint_ + "=1.0"),
            std::string::npos);
}

TEST_F(HeldOutGain, IsNamedInATrialOfFewPosturesBesideALongMotion) {
  const Recording recording = AsTrial("swing", TrialKind::kCalibration, 1);
  const Recording motion = AsTrial("sine", TrialKind::kSine, 3, 400);
  Recording few = AsTrial("check", TrialKind::kRandom, 2, 10);
  few.q.col(kCoordinate) *= kGain;
  const Recording held_out = JoinTrials(motion, few);
  const Recording thinned = WithThinnedMotions(held_out, 40);
  EXPECT_EQ(thinned.posture_count(), 50);
  EXPECT_EQ(std::count(thinned.trial.begin(), thinned.trial.end(), 1), 10);

  const ModelComparison comparison = CompareModels(
      Calibrate(model_, recording, base_, ModelKind::kGeometric, {}), model_, recording, base_, {});
  const HeldOut judged = JudgeOnTrials(comparison, held_out, {});
  const std::vector<std::string> found =
      FindContradictions(project_, {model_, base_}, recording, held_out, comparison, judged.table);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("in trial check (--accept gain:" + joint_ + "@check=1.0"),
            std::string::npos)
      << found[0];
}

TEST_F(HeldOutGain, NothingConfirmsAnOffsetThatIsUndoneInAllHeldOutTrials) {
  Measurements measured;
  measured.calibration = AsTrial("swing", TrialKind::kCalibration, 1);
  measured.validation =
      JoinTrials(AsTrial("check", TrialKind::kRandom, 2), AsTrial("again", TrialKind::kRandom, 4));
  const auto accept = [&](const std::vector<std::string>& names) {
    Measurements copy = measured;
    AcceptMistakes(project_, names, copy);
    std::string all;
    for (const auto& one : UnconfirmedCorrections(names, project_, copy)) all += one + "\n";
    return all;
  };
  const std::string why = "(check, again), and not in those of the estimate (swing)";
  const std::string offset = "offset:" + joint_ + "@";
  EXPECT_NE(accept({offset + "check=2", offset + "again=2"}).find(why), std::string::npos);
  EXPECT_EQ(accept({offset + "check=2"}).find(why), std::string::npos);
  EXPECT_EQ(accept({offset + "swing=-2"}).find(why), std::string::npos);
  EXPECT_EQ(accept({"gain:" + joint_ + "=1.01"}).find(why), std::string::npos);
  const std::string gain = "gain:" + joint_ + "@";
  EXPECT_NE(accept({gain + "check=1.02", gain + "again=1.02"}).find(why), std::string::npos);
}

}  // namespace
}  // namespace elastocal
