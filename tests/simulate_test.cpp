// SPDX-License-Identifier: Apache-2.0
// The command `simulate`: a recording folder as a laboratory would fill it.

#include <algorithm>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/experiment.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class Simulate : public testing::Test {
 protected:
  std::string Folder(const std::string& name) const { return (scratch_.path() / name).string(); }
  ProgramResult Run(const std::string& folder, const std::string& more) const {
    return RunProgram("simulate " + SourceFile("tests/robots/arm6_project.yaml").string() + " -o " +
                      Folder(folder) + " --arm-postures 2 --random-postures 1 " + more);
  }

  ScratchFolder scratch_;
};

TEST_F(Simulate, WritesAFolderThatDependsOnTheSeedAlone) {
  const ProgramResult one = Run("one", "--threads 1 --json " + Folder("one.json"));
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_NE(one.out.find("upper_random"), std::string::npos) << one.out;
  EXPECT_EQ(Run("three", "--threads 3 --quiet").exit_code, 0);
  EXPECT_EQ(Run("other", "--robot-seed -1").exit_code, 2);
  EXPECT_EQ(Run("other", "--seed 2 --quiet").exit_code, 0);
  const Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  const Experiment experiment = ReadExperiment(Folder("one"), project);
  ASSERT_EQ(experiment.trials.size(), 4u);
  for (const TrialFiles& trial : experiment.trials) {
    for (const auto& file : {trial.markers, trial.joints, trial.truth}) {
      const auto name = file.filename();
      EXPECT_EQ(ReadFile(file), ReadFile(scratch_.path() / "three" / name)) << name;
      EXPECT_NE(ReadFile(file), ReadFile(scratch_.path() / "other" / name)) << name;
    }
  }
  EXPECT_EQ(ReadFile(scratch_.path() / "one/truth.yaml"),
            ReadFile(scratch_.path() / "three/truth.yaml"));
  const auto json = nlohmann::json::parse(ReadFile(Folder("one.json")));
  EXPECT_EQ(json.at("trials").size(), 4u);
}

TEST_F(Simulate, PlaysOneTrialWithTheOptionsGiven) {
  const std::string settings = scratch_.Write("settings.yaml", "lag_s: 3\nmarker_noise_mm: 1\n");
  const ProgramResult result = Run("one", "--trials upper_random --nominal --settings " + settings +
                                              " --lag-s 4 --json " + Folder("one.json"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(ReadFile(Folder("one.json")));
  ASSERT_EQ(json.at("trials").size(), 1u);
  EXPECT_EQ(json["trials"][0]["lag_s"], 4.0) << "the command line goes before the file";
}

TEST_F(Simulate, MeasuresThePlacesOfMarkersThatItIsTold) {
  const auto table = [&](const std::string& folder, const std::string& of) {
    const ProgramResult result = Run(folder, "--trials upper_random --marker-places-mm 1 " + of);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::istringstream lines(ReadFile(Folder(folder) + "/marker_places.csv"));
    std::set<std::string> rows;
    for (std::string line; std::getline(lines, line);) rows.insert(line);
    return rows;
  };
  const std::set<std::string> all = table("all", ""),
                              tool = table("tool", "--marker-places-of TOOL");
  EXPECT_EQ(all.size(), 11u);  // a heading, three clusters, a marker by itself
  EXPECT_EQ(tool.size(), 4u);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), tool.begin(), tool.end()));
}

TEST_F(Simulate, PlaysAUsersPosturesAndTrajectory) {
  const std::string postures =
      scratch_.Write("postures.csv", "turret_joint,elbow_joint\n0,0.1\n0.3,0.2\n-0.3,0.5\n");
  ASSERT_EQ(Run("p", "--quiet --postures " + postures).exit_code, 0);
  const Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  const Experiment played = ReadExperiment(Folder("p"), project);
  ASSERT_EQ(played.trials.size(), 1u);
  EXPECT_EQ(played.trials[0].name, "postures");
  EXPECT_EQ(played.trials[0].kind, TrialKind::kCalibration);
  EXPECT_EQ(played.trials[0].chains, std::vector<int>{0});  // `wrist` begins beyond the root

  const std::string motion =
      scratch_.Write("motion.csv", "time,turret_joint,support\n0,0,none\n2,0.3,none\n5,0,none\n");
  const ProgramResult result =
      Run("m", "--kind random --chains wrist --json " + Folder("m.json") + " --motion " + motion);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Experiment followed = ReadExperiment(Folder("m"), project);
  EXPECT_EQ(followed.trials[0].kind, TrialKind::kRandom);
  EXPECT_EQ(followed.trials[0].chains, std::vector<int>{1});
  const auto json = nlohmann::json::parse(ReadFile(Folder("m.json")));
  EXPECT_EQ(json["trials"][0]["frames"], 1150);  // 5 s of rest, 5 s of motion, 1.5 s of rest
}

TEST_F(Simulate, DoesNotReplaceTheMotionThatItPlays) {
  std::filesystem::create_directory(Folder("here"));
  const std::string motion = scratch_.Write("here/motion.csv", "turret_joint\n0\n0.3\n");
  const ProgramResult result = Run("here", "--postures " + motion);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("motion.csv"), std::string::npos) << result.err;
  EXPECT_EQ(ReadFile(motion), "turret_joint\n0\n0.3\n");
}

// A laboratory's recording whose files have the names of the simulation's.
TEST_F(Simulate, DoesNotReplaceRecordingsThatItDidNotMake) {
  ASSERT_EQ(Run("lab", "--quiet --trials upper_random").exit_code, 0);
  std::filesystem::remove(Folder("lab/truth.yaml"));
  const std::string experiment = ReadFile(Folder("lab/experiment.yaml"));
  const std::string markers = ReadFile(Folder("lab/upper_random.tsv"));
  const ProgramResult refused = Run("lab", "--seed 2 --trials upper_random");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("experiment.yaml"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
  EXPECT_EQ(ReadFile(Folder("lab/experiment.yaml")), experiment);
  EXPECT_EQ(ReadFile(Folder("lab/upper_random.tsv")), markers);
  // A single file with the name of a trial is enough.
  std::filesystem::create_directory(Folder("other"));
  const std::string alone = scratch_.Write("other/upper_random.tsv", "the laboratory's");
  EXPECT_EQ(Run("other", "--trials upper_random").exit_code, 3);
  EXPECT_EQ(ReadFile(alone), "the laboratory's");

  EXPECT_EQ(Run("lab", "--quiet --seed 2 --trials upper_random --force").exit_code, 0);
  EXPECT_NE(ReadFile(Folder("lab/upper_random.tsv")), markers);
}

// Somebody added a trial of a real robot to the experiment.yaml of a simulation.
TEST_F(Simulate, KeepsRecordingsThatWereAddedToItsExperiment) {
  ASSERT_EQ(Run("one", "--quiet --trials upper_random").exit_code, 0);
  const std::string markers = scratch_.Write("one/real.tsv", "the laboratory's");
  const std::string joints = scratch_.Write("one/real.csv", "the laboratory's, too");
  const std::string experiment = ReadFile(Folder("one/experiment.yaml"));
  scratch_.Write("one/experiment.yaml", experiment +
                                            "  - {name: real, kind: random, chains: [arm], "
                                            "markers: real.tsv, joints: real.csv}\n");
  ASSERT_EQ(Run("one", "--quiet --seed 2 --trials upper_random").exit_code, 0);
  EXPECT_EQ(ReadFile(markers), "the laboratory's");
  EXPECT_EQ(ReadFile(joints), "the laboratory's, too");
}

TEST_F(Simulate, ReplacesAnEarlierSimulationAsAWhole) {
  ASSERT_EQ(Run("one", "--quiet").exit_code, 0);
  const std::string notes = scratch_.Write("one/notes.txt", "mine");
  ASSERT_EQ(Run("one", "--quiet --seed 2 --trials upper_random").exit_code, 0);
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(Folder("one"))) {
    names.insert(entry.path().filename());
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"experiment.yaml", "notes.txt", "truth.yaml", "upper_random.csv",
                                   "upper_random.tsv", "upper_random_waist.csv"}));
  // Files that the earlier simulation did not write are not replaced either.
  const std::string other = scratch_.Write("one/arm.csv", "mine");
  const ProgramResult result = Run("one", "--trials arm");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("arm.csv"), std::string::npos) << result.err;
  EXPECT_EQ(ReadFile(other), "mine");
}

TEST_F(Simulate, KeepsItsOutputsApart) {
  const ProgramResult result = Run("one", "--trials arm --json " + Folder("one/arm.csv"));
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("arm.csv"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(Folder("one")));
}

TEST_F(Simulate, NamesOfTrialsAreNoPathsAndNotThoseOfMotions) {
  EXPECT_EQ(TrialNameOf("chains/arm_left_motion.csv"), "arm_left");
  EXPECT_EQ(TrialNameOf("motion.csv"), "motion");
  EXPECT_EQ(TrialNameOf("_motion.csv"), "_motion");
  EXPECT_EQ(TrialNameOf("my motion: \xc3\xa4.csv"), "my_motion____");
  EXPECT_EQ(TrialNameOf("...csv"), "_..");
  // A motion of `plan --per-chain` can be played into its own folder.
  std::filesystem::create_directory(Folder("here"));
  const std::string motion =
      scratch_.Write("here/arm_motion.csv", "time,turret_joint,support\n0,0,none\n2,0.3,none\n");
  ASSERT_EQ(Run("here", "--quiet --motion " + motion).exit_code, 0);
  EXPECT_TRUE(ReadFile(motion).starts_with("time,turret_joint"));
  EXPECT_TRUE(std::filesystem::exists(Folder("here/arm.tsv")));
}

// The remaining error is the micrometre to which marker files are rounded.
TEST_F(Simulate, AMatchedTruthIsWhatCalibrateFinds) {
  const std::string project = SourceFile("tests/robots/arm6_project.yaml").string();
  const ProgramResult simulated =
      RunProgram("simulate " + project + " -o " + Folder("matched") +
                 " --arm-postures 15 --trials calibration --matched --nominal --quiet "
                 "--upper-geometry-scale 1 --upper-elasticity-scale 1 --marker-mm 3");
  ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
  const std::string truth = ReadFile(Folder("matched/truth.yaml"));
  EXPECT_NE(truth.find("matched: true"), std::string::npos);
  EXPECT_NE(truth.find("elbow_joint.theta: {value: "), std::string::npos) << truth;
  const ProgramResult calibrated = RunProgram("calibrate " + project + " --recording " +
                                              Folder("matched") + " -o " + Folder("out"));
  ASSERT_EQ(calibrated.exit_code, 0) << calibrated.err;
  const auto summary = nlohmann::json::parse(ReadFile(Folder("out/summary.json")));
  EXPECT_GT(summary.at("rmse_3d_mm").at("uncalibrated"), 1.0);
  EXPECT_LT(summary.at("rmse_3d_mm").at("full"), 2e-3);
  EXPECT_TRUE(summary.at("knocks").empty());
}

// A reversed sign spoils the alignment of the clocks, unless it is known before that.
TEST_F(Simulate, CheckAlignsClocksWithWhatItIsToldToAccept) {
  const std::string project = SourceFile("tests/robots/arm6_project.yaml").string();
  const std::string folder = Folder("reversed"), out = Folder("out");
  ASSERT_EQ(
      RunProgram("simulate " + project + " -o " + folder + " --seed 3 --trials calibration --quiet")
          .exit_code,
      0);
  std::istringstream log(ReadFile(folder + "/arm.csv"));
  std::string text, line;
  std::getline(log, line);
  const std::string header = line;
  const std::string before = header.substr(0, header.find(",shoulder_joint,"));
  const auto column = std::ranges::count(before, ',') + 1;
  while (std::getline(log, line)) {
    std::size_t at = 0;
    for (std::ptrdiff_t c = 0; c < column; ++c) at = line.find(',', at) + 1;
    const bool negative = line[at] == '-';
    text += line.substr(0, at) + (negative ? "" : "-") + line.substr(negative ? at + 1 : at) + "\n";
  }
  WriteFile(folder + "/arm.csv", header + "\n" + text);
  const std::string accept = " --recording " + folder + " --accept sign:shoulder_joint";
  ASSERT_EQ(RunProgram("calibrate " + project + accept + " -o " + out).exit_code, 0);
  const ProgramResult checked = RunProgram("check " + project + " --calibration " + out + accept);
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_TRUE(checked.out.starts_with("Unchanged: ")) << checked.out;
}

TEST_F(Simulate, RefusesWhatIsNotThere) {
  const auto refused = [&](const std::string& more, const std::string& part, int exit_code = 3) {
    const ProgramResult result = Run("none", more);
    EXPECT_EQ(result.exit_code, exit_code) << more;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(Folder("none"))) << more;
  };
  refused("--trials upper_sin", "did you mean 'upper_sine'");
  refused("--marker-noise-mm much", "--marker-noise-mm", 2);
  refused("--lost-marker NOSE", "NOSE");
  refused("--marker-places-mm 1 --marker-places-of NOSE", "there is no cluster 'NOSE'");
  refused("--marker-places-of NOSE", "--marker-places-mm", 2);
  refused("--free", "free");
  refused("--time-step-s 0.003", "hundredth");
  refused("--postures " + Folder("no.csv"), "no.csv");
  const std::string postures = scratch_.Write("postures.csv", "elbow_joint\n0\n0.1\n");
  refused("--postures " + postures + " --chains arn", "did you mean 'arm'");
  refused("--motion " + postures, "no column 'time'");
  refused("--chains arm", "--chains: --motion FILE or --postures FILE was expected with it");
  const std::string motion = scratch_.Write("motion.csv", "time,elbow_joint\n0,0\n1,0.1\n");
  refused("--deploy " + Folder("out") + " --motion " + motion + " --matched",
          "--matched: it is for simulated recordings, and --deploy records nothing");
}

}  // namespace
}  // namespace elastocal
