// SPDX-License-Identifier: Apache-2.0
// A cluster of markers is knocked during an experiment of the whole body. The knock is found and
// named and does not affect the result.

#include <gtest/gtest.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/pipeline/cross_validate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/screening/knocks.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/standing_humanoid.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr int kPostures = 16;  // per trial
const Eigen::Vector3d kPush(3e-3, 0.0, -4e-3);

struct KnockExperiment {
  const StandingHumanoid& robot;
  Eigen::VectorXd truth;
  StandingOptions options;
  std::vector<LabelCluster> clusters;

  explicit KnockExperiment(std::uint64_t seed) : robot(Robot()), truth(robot.DrawTruth(seed)) {
    options.marker_sd = 0.05e-3;
    options.torque_sensors = robot.project.torque_sensors;
    options.seed = seed;
    for (const MarkerCluster& cluster : robot.project.clusters) {
      clusters.push_back({cluster.name, cluster.markers});
    }
  }

  static const StandingHumanoid& Robot() {
    static const StandingHumanoid robot(kPostures);
    return robot;
  }

  const LabelCluster& Cluster(const std::string& name) const {
    for (const LabelCluster& cluster : clusters) {
      if (cluster.name == name) return cluster;
    }
    throw std::runtime_error("no cluster " + name);
  }

  Recording Clean() const { return robot.Record(truth, options); }

  /// From `posture` on, the cluster has another place on its link. Its markers come from a robot
  /// that carries them there, with the same noise.
  void Push(const std::string& name, int posture, Recording& recording) const {
    Eigen::VectorXd pushed = truth;
    for (int m : Cluster(name).markers) {
      for (int i = 0; i < robot.model.parameter_count(); ++i) {
        const Parameter& parameter = robot.model.parameters[i];
        if (parameter.marker == m) {
          pushed.segment<3>(i) += kPush;
          break;
        }
      }
    }
    const Recording other = robot.Record(pushed, options);
    const int after = recording.posture_count() - posture;
    for (int m : Cluster(name).markers) {
      recording.markers.middleCols<3>(3 * m).bottomRows(after) =
          other.markers.middleCols<3>(3 * m).bottomRows(after);
    }
  }

  std::vector<Knock> Find(const Recording& recording) const {
    return FindKnocks(robot.model, recording, robot.base, clusters, {});
  }
};

void ExpectOneKnock(const std::vector<Knock>& knocks, const std::string& cluster, int last_before,
                    int posture) {
  ASSERT_EQ(knocks.size(), 1u) << (knocks.empty()
                                       ? ""
                                       : knocks[0].cluster + " " +
                                             (knocks.size() > 1 ? knocks[1].cluster : ""));
  EXPECT_EQ(knocks[0].cluster, cluster);
  EXPECT_EQ(knocks[0].posture, posture);
  EXPECT_EQ(knocks[0].last_before, last_before);
  // The tolerance allows for nonlinear errors of the robot, and for errors that the step shares
  // with others.
  EXPECT_NEAR(knocks[0].distance, kPush.norm(), 0.15e-3);
  EXPECT_GT(knocks[0].significance, 1.0);
}

// Only its own trial, the second of five, shows the left arm.
TEST(Knock, OfAHandInTheMiddleOfItsTrialIsFound) {
  const KnockExperiment experiment(11);
  Recording recording = experiment.Clean();
  const int middle = kPostures + kPostures / 2;
  experiment.Push("LHAND", middle, recording);
  ExpectOneKnock(experiment.Find(recording), "LHAND", middle - 1, middle);
}

// The first three trials show the trunk.
TEST(Knock, OfTheTrunkBetweenTrialsIsFound) {
  const KnockExperiment experiment(12);
  Recording recording = experiment.Clean();
  experiment.Push("TRUNK", 2 * kPostures, recording);
  ExpectOneKnock(experiment.Find(recording), "TRUNK", 2 * kPostures - 1, 2 * kPostures);
}

// Relative to the waist, all other markers seem to move together.
TEST(Knock, OfTheWaistIsNotTakenForOneOfTheOthers) {
  const KnockExperiment experiment(13);
  Recording recording = experiment.Clean();
  const int middle = 3 * kPostures + kPostures / 2;
  experiment.Push("WAIST", middle, recording);
  ExpectOneKnock(experiment.Find(recording), "WAIST", middle - 1, middle);
}

// A few of the moments first tell whether there may be a knock.
TEST(Knock, IsFoundAmongThousandsOfMoments) {
  const Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
  const BaseParameters base = FindBaseParameters(model, project.identifiability);
  constexpr int kMoments = 1200, kFirstAfter = 701;
  const MarkerCluster& cluster = project.clusters.back();
  Eigen::VectorXd pushed = Eigen::VectorXd::Zero(model.parameter_count());
  for (const int m : cluster.markers) {
    const int x = FindParameter(model.parameters, "marker." + project.markers[m].name + ".x");
    pushed.segment<3>(x) = kPush;
  }
  const auto record = [&](const Eigen::VectorXd& errors) {
    Recording recording = MakeSyntheticRecording(model, errors, {.postures = kMoments});
    recording.trials = {{"swing", TrialKind::kSine, {project.chains.front().name}}};
    recording.trial.assign(kMoments, 0);
    return recording;
  };
  std::vector<LabelCluster> clusters;
  for (const MarkerCluster& of : project.clusters) clusters.push_back({of.name, of.markers});
  Recording recording = record(Eigen::VectorXd::Zero(model.parameter_count()));
  EXPECT_TRUE(FindKnocks(model, recording, base, clusters, {}).empty());
  recording.markers.bottomRows(kMoments - kFirstAfter) =
      record(pushed).markers.bottomRows(kMoments - kFirstAfter);
  ExpectOneKnock(FindKnocks(model, recording, base, clusters, {}), cluster.name, kFirstAfter - 1,
                 kFirstAfter);
}

TEST(Knock, OfTwoClustersAreBothFound) {
  const KnockExperiment experiment(14);
  Recording recording = experiment.Clean();
  experiment.Push("LTHIGH", 3 * kPostures + 5, recording);
  experiment.Push("RHAND", 2 * kPostures + 6, recording);
  std::vector<Knock> knocks = experiment.Find(recording);
  ASSERT_EQ(knocks.size(), 2u);
  if (knocks[0].cluster != "RHAND") std::swap(knocks[0], knocks[1]);
  EXPECT_EQ(knocks[0].cluster, "RHAND");
  EXPECT_EQ(knocks[0].posture, 2 * kPostures + 6);
  EXPECT_EQ(knocks[1].cluster, "LTHIGH");
  EXPECT_EQ(knocks[1].posture, 3 * kPostures + 5);
}

TEST(Knock, IsNotSeenWhereThereWasNone) {
  for (std::uint64_t seed = 20; seed < 26; ++seed) {
    const KnockExperiment experiment(seed);
    const std::vector<Knock> knocks = experiment.Find(experiment.Clean());
    EXPECT_TRUE(knocks.empty()) << seed << " " << knocks[0].cluster << " " << knocks[0].distance;
  }
}

// Two of twelve robots seemed to have a foot knocked upwards by 2 mm where the robot changes feet.
TEST(Knock, IsNoErrorOfTheTorques) {
  for (const std::uint64_t seed : {30, 40}) {
    KnockExperiment experiment(seed);
    experiment.options.torque_sd = 2.0;
    EXPECT_TRUE(experiment.Find(experiment.Clean()).empty()) << seed;
  }
}

// If the model is rigid, a knock is the only explanation for a foot that sinks when it carries the
// robot alone.
TEST(Knock, IsNoLegThatGivesWayWhereARigidRobotIsEstimated) {
  for (const std::uint64_t seed : {15, 17}) {
    const KnockExperiment experiment(seed);
    Project project = experiment.robot.project;
    project.elasticity = {.torsion = std::vector<std::string>(),
                          .bending = std::vector<std::string>(),
                          .base = false};
    Recording recording = experiment.Clean();
    const ErrorModel rigid = MakeProjectModel(project, recording.trials);
    const BaseParameters base = FindBaseParameters(rigid, project.identifiability);
    EXPECT_TRUE(FindKnocks(rigid, recording, base, experiment.clusters, {}).empty());
    const int middle = kPostures + kPostures / 2;
    experiment.Push("LHAND", middle, recording);
    ExpectOneKnock(FindKnocks(rigid, recording, base, experiment.clusters, {}), "LHAND", middle - 1,
                   middle);
  }
}

// With the cluster split, the estimates are those of the clean recording. The noise is the same, so
// that they differ by less than their uncertainty.
TEST(Knock, LeavesNoTraceInTheParametersOnceTheClusterIsTwo) {
  const KnockExperiment experiment(15);
  const StandingHumanoid& robot = experiment.robot;
  const Recording clean = experiment.Clean();
  const CalibrationResult expected =
      Calibrate(robot.model, clean, robot.base, ModelKind::kFull, {});
  Recording recording = clean;
  experiment.Push("LHAND", kPostures + kPostures / 2, recording);
  ErrorModel model = robot.model;
  SplitMarkers(experiment.Find(recording), model, recording);
  ASSERT_EQ(model.marker_count(), robot.model.marker_count() + 3);
  const BaseParameters base = FindBaseParameters(model, robot.project.identifiability);
  const CalibrationResult result = Calibrate(model, recording, base, ModelKind::kFull, {});
  EXPECT_EQ(result.termination, Termination::kConverged) << result.message;
  EXPECT_LT(result.outliers.size(), 3u);
  int compared = 0;
  for (int i : robot.base.kept) {  // earlier parameters keep their indices
    const Parameter& parameter = robot.model.parameters[i];
    ASSERT_EQ(model.parameters[i].name, parameter.name);
    if (IsExternal(parameter.kind) || result.status[i] != ParameterStatus::kEstimated ||
        expected.status[i] != ParameterStatus::kEstimated) {
      continue;
    }
    ++compared;
    EXPECT_LT(std::abs(result.delta[i] - expected.delta[i]), 3.0 * expected.sd[i])
        << parameter.name;
  }
  EXPECT_GT(compared, 100);
}

constexpr int kFolds = 3;

/// Held-out distances of the full model, m, as by `calibrate --kfold 3`.
Eigen::MatrixXd HeldOutDistances(const KnockExperiment& experiment, const Recording& recording,
                                 int knocks_of_all) {
  const Project& project = experiment.robot.project;
  Measurements measured;
  measured.calibration = recording;
  const RecordedModel robot = MakeRecordedModel(project, {}, measured);
  EXPECT_EQ(static_cast<int>(robot.knocks.size()), knocks_of_all);
  ModelComparison comparison;
  comparison.kinds = {ModelKind::kFull};
  comparison.results[static_cast<int>(ModelKind::kFull)] =
      Calibrate(robot.model, measured.calibration, robot.base, ModelKind::kFull, {});
  const CrossValidation folds = CrossValidateExperiment(
      {project, recording, {}, {}}, robot, comparison, {.folds = kFolds, .threads = 2});
  const auto full = static_cast<int>(ModelKind::kFull);
  EXPECT_EQ(folds.distances[full].cols(), recording.marker_count());
  EXPECT_LE(folds.metrics_without_outliers[full].observations, folds.metrics[full].observations);
  return folds.distances[full];
}

/// Whether posture i is between the last training posture of its fold before a knock and the first
/// one after it.
bool Between(const std::vector<int>& fold_of, int i, int knock) {
  int before = knock - 1;
  int after = knock;
  while (fold_of[before] == fold_of[i]) --before;
  while (fold_of[after] == fold_of[i]) ++after;
  return before < i && i < after;
}

// The same robot, postures and noise without a knock, with one in the middle, and with one before
// the last three postures, the fewest that can reveal it. Each fold finds the knock by itself.
TEST(Knock, FoldsErrOnlyByAKnockThatTheirTrainingPosturesDoNotShow) {
  const KnockExperiment experiment(16);
  const std::vector<int> fold_of = DealFolds(experiment.Clean(), {.folds = kFolds});
  const auto with_knock_at = [&](int posture) {
    Recording recording = experiment.Clean();
    experiment.Push("LHAND", posture, recording);
    return HeldOutDistances(experiment, recording, 1);
  };
  const Eigen::MatrixXd clean = HeldOutDistances(experiment, experiment.Clean(), 0);
  const int middle = kPostures + kPostures / 2;
  const int late = 2 * kPostures - 3;  // the hand is seen in this trial only
  const Eigen::MatrixXd knocked = with_knock_at(middle), knocked_late = with_knock_at(late);
  EXPECT_TRUE(Between(fold_of, middle, middle));
  for (int m : experiment.Cluster("LHAND").markers) {
    // Errors before and after the knock are as without it. Postures around it, which may be on
    // either side, have none.
    for (int i = kPostures; i < 2 * kPostures; ++i) {
      EXPECT_EQ(std::isnan(knocked(i, m)), Between(fold_of, i, middle)) << i;
      if (Between(fold_of, i, middle)) continue;
      EXPECT_NEAR(knocked(i, m), clean(i, m), 1e-3) << i;  // half of the push is 2.5 mm
    }
    // A fold that leaves out one of these three does not know the knock and errs by it. If folds
    // knew all postures, they would not.
    for (int i = late; i < late + 3; ++i) EXPECT_GT(knocked_late(i, m), clean(i, m) + 2e-3) << i;
  }
}

}  // namespace
}  // namespace elastocal
