// SPDX-License-Identifier: Apache-2.0
// Joint logs with their columns in another order, and clusters that moved between trials.

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/mistakes/column_order.hpp"
#include "elastocal/mistakes/find_contradictions.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "elastocal/validation/held_out.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// An arm of seven coordinates with errors of half a degree, and trials of 40 postures.
class TrialOrders : public testing::Test {
 protected:
  TrialOrders() { truth_ = DrawErrors(model_, base_.kept, {{ParameterKind::kTheta, 0.01}}, 1); }

  Recording AsTrial(const ErrorModel& model, const std::string& name, TrialKind kind,
                    std::uint64_t seed) const {
    Recording recording = MakeSyntheticRecording(model, truth_, {.postures = 40, .seed = seed});
    recording.trials = {{name, kind, {project_.chains.front().name}}};
    recording.trial.assign(40, 0);
    return recording;
  }
  Recording AsTrial(const std::string& name, TrialKind kind, std::uint64_t seed) const {
    return AsTrial(model_, name, kind, seed);
  }

  std::string Contradiction(const Recording& recording, const Recording& held_out) const {
    const ModelComparison comparison =
        CompareModels(Calibrate(model_, recording, base_, ModelKind::kGeometric, {}), model_,
                      recording, base_, {});
    const auto found =
        FindContradictions(project_, {model_, base_}, recording, held_out, comparison,
                           JudgeOnTrials(comparison, held_out, {}).table);
    return found.empty() ? "" : found.front();
  }

  int CoordinateOf(const std::string& name) const {
    for (const Joint& joint : project_.tree.joints) {
      if (joint.name == name) return joint.coordinate;
    }
    return -1;
  }

  Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  ErrorModel model_ = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  BaseParameters base_ = FindBaseParameters(model_, project_.identifiability);
  Eigen::VectorXd truth_;
};

void ExpectWithin(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST_F(TrialOrders, ColumnsInAnotherOrderAreFoundAndPutRight) {
  const Recording right = AsTrial("swing", TrialKind::kCalibration, 1);
  EXPECT_TRUE(FindColumnOrders(model_, right).empty());
  const int a = CoordinateOf("turret_joint"), b = CoordinateOf("shoulder_joint"),
            c = CoordinateOf("elbow_joint"), d = CoordinateOf("bend_joint");
  Recording wrong = JoinTrials(right, AsTrial("other", TrialKind::kCalibration, 2));
  const Eigen::MatrixXd q = wrong.q;
  for (const auto& [to, from] : std::vector<std::pair<int, int>>{{a, b}, {b, c}, {c, d}, {d, a}}) {
    wrong.q.col(to).head(40) = q.col(from).head(40);
  }
  const auto error_of = [&](const Recording& one) { return (one.q - q).norm() + 1e-4; };
  const std::vector<RecordingMistake> mistakes =
      FindMistakesBy(project_, wrong, error_of(wrong), error_of);
  ASSERT_FALSE(mistakes.empty());
  ExpectWithin(mistakes[0].what, "in another order than its header says in trial swing: ");
  ExpectWithin(mistakes[0].what, "shoulder_joint has the one of turret_joint");
  EXPECT_EQ(mistakes[0].corrected.q, q);
  EXPECT_EQ(DescribeMistake(mistakes[0]).find("--accept"), std::string::npos);
}

TEST_F(TrialOrders, AColumnThatIsACopyOfAnotherOneIsNamed) {
  const int a = CoordinateOf("shoulder_joint"), b = CoordinateOf("elbow_joint");
  const Recording right = AsTrial("swing", TrialKind::kCalibration, 1);
  Recording wrong = right;
  wrong.q.col(b) = wrong.q.col(a);
  const std::vector<TriedCorrection> found = FindColumnOrders(model_, wrong);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].what.rfind("elbow_joint: its column is a copy of that of shoulder_joint", 0),
            0u)
      << found[0].what;
  // This holds usually: from so far off, the search does not always succeed.
  EXPECT_LT(Median((found[0].corrected.q - right.q).col(b).cwiseAbs()),
            0.5 * Median((wrong.q - right.q).col(b).cwiseAbs()));

  // A logger that copies a column does so in all trials, which is one suspicion.
  Recording both = JoinTrials(right, AsTrial("other", TrialKind::kCalibration, 2));
  both.q.col(b) = both.q.col(a);
  const std::vector<TriedCorrection> in_both = FindColumnOrders(model_, both);
  ASSERT_EQ(in_both.size(), 1u);
  ExpectWithin(in_both[0].what, "in trial swing, other, and the markers");
}

// The trial of the estimate does not tell where its cluster was on another day.
TEST_F(TrialOrders, AClusterThatMovedBetweenTrialsIsNamed) {
  const Recording recording = AsTrial("swing", TrialKind::kCalibration, 1);
  EXPECT_EQ(Contradiction(recording, AsTrial("check", TrialKind::kRandom, 2)), "");
  ErrorModel moved = model_;
  for (Marker& marker : moved.markers) {
    if (marker.name.rfind("TOOL", 0) == 0) marker.p_link_marker += Eigen::Vector3d(4e-3, 3e-3, 0);
  }
  const std::string said = Contradiction(recording, AsTrial(moved, "check", TrialKind::kRandom, 2));
  ExpectWithin(said, "cluster TOOL seems to lie 5.0 mm elsewhere from trial check, posture 1 on");

  ErrorModel other = model_;
  for (Marker& marker : other.markers) {
    if (marker.name == "TOOL_2") marker.p_link_marker += Eigen::Vector3d(0.0, 0.15, 0.2);
  }
  const std::string label =
      Contradiction(recording, AsTrial(other, "check", TrialKind::kRandom, 2));
  ExpectWithin(label, "marker TOOL_2 seems to be elsewhere on its link in trial check");
  ExpectWithin(label, "(does it have the label of another marker in some of them?)");
}

}  // namespace
}  // namespace elastocal
