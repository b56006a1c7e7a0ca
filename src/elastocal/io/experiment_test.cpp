// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/experiment.hpp"

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// A folder with the empty files a.tsv, a.csv, b.tsv, b.csv and sub/c.tsv.
class ExperimentTest : public testing::Test {
 protected:
  ExperimentTest() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("experiment_") + test->name());
    fs::remove_all(folder_);
    for (const char* file : {"a.tsv", "a.csv", "b.tsv", "b.csv", "sub/c.tsv"}) {
      WriteFile(folder_ / file, "");
    }
  }
  ~ExperimentTest() override { fs::remove_all(folder_); }

  Experiment Parse(const std::string& text) const {
    return ParseExperiment(text, folder_, project_);
  }

  void ExpectError(const std::string& text, std::initializer_list<std::string> parts) const {
    ExpectInputError([&] { Parse(text); }, parts);
  }

  /// Expects an error in a trial on line 1 that has `more` among its keys.
  void ExpectTrialError(const std::string& more, std::initializer_list<std::string> parts) const {
    ExpectError("trials: [{name: a, markers: a.tsv, joints: a.csv" + more + "}]", parts);
  }

  fs::path folder_;
  Project project_ = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
};

TEST_F(ExperimentTest, ReadsTrials) {
  const Experiment experiment = Parse(
      "trials:\n"
      "  - name: swing\n"
      "    chain: left_leg\n"
      "    support: [right_sole]\n"
      "    markers: a.tsv\n"
      "    joints: a.csv\n"
      "  - {name: arms, kind: sine, chains: [left_arm, right_arm], support: [left_sole, "
      "right_sole],\n"
      "     markers: ./sub/../sub/c.tsv, joints: b.csv}\n");
  ASSERT_EQ(experiment.trials.size(), 2u);
  const TrialFiles& swing = experiment.trials[0];
  EXPECT_EQ(swing.name, "swing");
  EXPECT_EQ(swing.kind, TrialKind::kCalibration);
  ASSERT_EQ(swing.chains.size(), 1u);
  EXPECT_EQ(project_.chains[swing.chains[0]].name, "left_leg");
  EXPECT_EQ(swing.support, std::vector<int>{FindLink(project_.tree, "right_sole")});
  EXPECT_EQ(swing.markers, folder_ / "a.tsv");
  EXPECT_EQ(swing.joints, folder_ / "a.csv");
  const TrialFiles& arms = experiment.trials[1];
  EXPECT_EQ(arms.kind, TrialKind::kSine);
  EXPECT_EQ(arms.chains.size(), 2u);
  EXPECT_EQ(arms.support.size(), 2u);
  EXPECT_EQ(arms.markers, folder_ / "sub" / "c.tsv");
}

TEST_F(ExperimentTest, ReadsTheAxisThatIsUpAndTheExpectedLag) {
  const std::string trials =
      "trials: [{name: a, chain: head, markers: a.tsv, joints: a.csv, expected_lag_s: -2.5}]";
  EXPECT_EQ(Parse(trials).trials[0].expected_lag_s, -2.5);
  EXPECT_EQ(Parse(trials).gravity, Eigen::Vector3d(0.0, 0.0, -9.81));
  EXPECT_EQ(Parse("up: z\n" + trials).gravity, Eigen::Vector3d(0.0, 0.0, -9.81));
  const Experiment experiment = Parse("up: y\n" + trials);
  EXPECT_EQ(experiment.gravity, Eigen::Vector3d(0.0, -9.81, 0.0));
  ExpectError("up: w\n" + trials, {"experiment.yaml:1: up", "x, y, z"});
  WriteExperiment(folder_, experiment, project_);
  const Experiment read = ReadExperiment(folder_, project_);
  EXPECT_EQ(read.gravity, experiment.gravity);
  EXPECT_EQ(read.trials[0].expected_lag_s, -2.5);
}

TEST_F(ExperimentTest, ReadsFramesOfTransforms) {
  const Experiment experiment = Parse(
      "trials: [{name: a, chain: head, markers: a.tsv, joints: a.csv, tf_frame: world, "
      "tf_bodies: [cameras/HEAD, WAIST]}]");
  WriteExperiment(folder_, experiment, project_);
  for (const Experiment& one : {experiment, ReadExperiment(folder_, project_)}) {
    EXPECT_EQ(one.trials[0].reading.tf_frame, "world");
    EXPECT_EQ(one.trials[0].reading.tf_bodies, (std::vector<std::string>{"cameras/HEAD", "WAIST"}));
  }
}

TEST_F(ExperimentTest, NamesWrongKeys) {
  ExpectError("", {"experiment.yaml:1: ", "'trials' is missing"});
  ExpectError("trails: []", {"experiment.yaml:1: ", "'trails'", "did you mean 'trials'"});
  ExpectError("trials: []", {"experiment.yaml:1: trials", "no trial"});
  ExpectError("trials: {name: a}", {"experiment.yaml:1: trials", "a list"});
  ExpectTrialError(", chain: head, feet: [left_sole]", {"experiment.yaml:1: ", "'feet'"});
  ExpectTrialError(", chain: head, suport: [left_sole]", {"did you mean 'support'"});
  ExpectError("trials:\n  - {markers: a.tsv, joints: a.csv, chain: head}", {":2: ", "'name'"});
  ExpectError("trials:\n  - {name: a, joints: a.csv, chain: head}", {":2: ", "'markers'"});
  ExpectError("trials:\n  - {name: a, markers: a.tsv, chain: head}", {":2: ", "'joints'"});
}

TEST_F(ExperimentTest, NamesWrongValues) {
  ExpectTrialError("", {"experiment.yaml:1: ", "'chain' and 'chains'"});
  ExpectTrialError(", chain: head, chains: [head]", {"one of the keys"});
  ExpectTrialError(", chains: []", {"chains", "no chain"});
  ExpectTrialError(", chains: [head, head]", {"chain comes twice"});
  ExpectTrialError(", chain: left_lag", {"'left_lag'", "did you mean 'left_leg'"});
  ExpectTrialError(", chain: head, support: left_sole", {"support", "a list"});
  ExpectTrialError(", chain: head, support: [left_soul]", {"did you mean 'left_sole'"});
  ExpectTrialError(", chain: head, support: [left_foot]", {"'left_foot' is not the tip"});
  ExpectTrialError(", chain: head, support: [left_sole, left_sole]", {"link comes twice"});
  ExpectError("trials:\n  - {name: ../b, chain: head, markers: a.tsv, joints: a.csv}",
              {"experiment.yaml:2: trials[0].name: found '../b'", "can name a file"});
  ExpectTrialError(", chain: head, kind: sinus",
                   {"experiment.yaml:1: ", "kind", "'sinus'", "did you mean 'sine'"});
}

TEST_F(ExperimentTest, NamesWrongFiles) {
  const std::string first = "trials:\n  - {name: a, chain: head, markers: a.tsv, joints: a.csv}\n";
  ExpectError(first + "  - {name: b, chain: head, markers: b.tsv, joints: c.csv}",
              {"experiment.yaml:3: ", "joints", "there is no file", "c.csv"});
  ExpectError(first + "  - {name: b, chain: head, markers: sub, joints: b.csv}",
              {"experiment.yaml:3: ", "markers", "there is no file"});
  ExpectError(first + "  - {name: b, chain: head, markers: ./a.tsv, joints: b.csv}",
              {"experiment.yaml:3: ", "markers", "a.tsv", "named twice"});
  ExpectError(first + "  - {name: a, chain: head, markers: b.tsv, joints: b.csv}",
              {"experiment.yaml:3: ", "second trial of the name 'a'"});
  ExpectInputError([&] { ReadExperiment(folder_, project_); },
                   {"experiment.yaml", "there is no such file"});
}

TEST_F(ExperimentTest, WritesWhatItReads) {
  Experiment written;
  written.trials.resize(4);
  const char* names[] = {"plain", "null", "a-b.c", "2"};
  for (std::size_t i = 0; i < written.trials.size(); ++i) {
    TrialFiles& trial = written.trials[i];
    trial.name = names[i];
    trial.kind = static_cast<TrialKind>(i);
    trial.chains = {static_cast<int>(i), 4};
    trial.markers = folder_ / "sub" / (trial.name + ".tsv");
    trial.joints = folder_ / (trial.name + ".csv");
    WriteFile(trial.markers, "");
    WriteFile(trial.joints, "");
  }
  written.trials[1].support = {FindLink(project_.tree, "left_sole"),
                               FindLink(project_.tree, "right_sole")};
  written.trials[2].free_root = true;
  WriteExperiment(folder_, written, project_);
  EXPECT_EQ(ReadFile(folder_ / "experiment.yaml").find(folder_.string()), std::string::npos);
  const Experiment read = ReadExperiment(folder_, project_);
  ASSERT_EQ(read.trials.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read.trials[i].name, written.trials[i].name);
    EXPECT_EQ(read.trials[i].kind, written.trials[i].kind);
    EXPECT_EQ(read.trials[i].chains, written.trials[i].chains);
    EXPECT_EQ(read.trials[i].support, written.trials[i].support);
    EXPECT_EQ(read.trials[i].free_root, written.trials[i].free_root);
    EXPECT_EQ(read.trials[i].markers, written.trials[i].markers);
    EXPECT_EQ(read.trials[i].joints, written.trials[i].joints);
  }
}

}  // namespace
}  // namespace elastocal
