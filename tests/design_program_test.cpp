// SPDX-License-Identifier: Apache-2.0
// The commands `design` and `assess` as their users run them.
#include <chrono>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class DesignProgram : public testing::Test {
 protected:
  std::string File(const std::string& name) const { return (scratch_.path() / name).string(); }
  std::string Talos() const { return SourceFile("models/talos/project.yaml").string(); }

  /// The TALOS project with one text replaced.
  std::string Changed(const std::string& from, const std::string& to) {
    std::string text = ReadFile(Talos());
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    const std::string urdf = "{urdf: talos.urdf}";
    text.replace(text.find(urdf), urdf.size(),
                 "{urdf: " + SourceFile("models/talos/talos.urdf").string() + "}");
    return scratch_.Write("project.yaml", text);
  }

  ScratchFolder scratch_;
};

TEST_F(DesignProgram, DesignsAndAssessesAndTellsTheTruthAboutBoth) {
  const std::string options = " --chains head_trunk --count 8 --seed 3 -q";
  const ProgramResult made =
      RunProgram("design " + Talos() + " -o " + File("postures.yaml") + options);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Project project = ReadProject(Talos());
  const auto postures = ReadPostureFile(File("postures.yaml"), project);
  ASSERT_EQ(postures.size(), 1u);
  EXPECT_EQ(postures[0].chain, "head_trunk");
  EXPECT_EQ(postures[0].q.size(), 8u);
  EXPECT_EQ(postures[0].support.size(), 2u);
  EXPECT_NE(ReadFile(File("postures_curves.svg")).find("</svg>"), std::string::npos);
  EXPECT_TRUE(
      ReadFile(File("postures_curves.csv")).starts_with("algorithm,chain,seed,postures,o1\n"));

  const ProgramResult assessed =
      RunProgram("assess " + Talos() + " --postures " + File("postures.yaml") + " --json " +
                 File("assessed.json") + " -q");
  ASSERT_EQ(assessed.exit_code, 0) << assessed.err;
  const auto summary = nlohmann::json::parse(ReadFile(File("postures_summary.json")));
  const auto found = nlohmann::json::parse(ReadFile(File("assessed.json")));
  const double index = summary["chains"][0]["index"];
  // The file has twelve digits.
  EXPECT_NEAR(found["chains"][0]["o1"].get<double>(), index, 1e-6 * index);
  EXPECT_TRUE(found["chains"][0]["infeasible"].empty());
  EXPECT_GT(found["chains"][0]["efficiency"].get<double>(), 0.9);

  const std::string first = ReadFile(File("postures.yaml"));
  RunProgram("design " + Talos() + " -o " + File("again.yaml") + options);
  EXPECT_EQ(ReadFile(File("again.yaml")), first);  // same seed, same postures
}

TEST_F(DesignProgram, EndsWithFourAndNamesTheLimitWhereNothingIsFeasible) {
  const std::string project = Changed("floor_mm: -1000", "floor_mm: -300");
  const ProgramResult result =
      RunProgram("design " + project + " --chains leg_left -o " + File("postures.yaml"));
  EXPECT_EQ(result.exit_code, 4) << result.err;
  EXPECT_NE(result.err.find("above the floor"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(File("postures.yaml")));
}

TEST_F(DesignProgram, NamesWhatIsWrongInTheProject) {
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& part) {
    const ProgramResult result =
        RunProgram("design " + Changed(from, to) + " -o " + File("postures.yaml"));
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
  };
  expect("[LKNEE, RKNEE]", "[LKNEE, RNEE]", "there is no sphere 'RNEE'");
  expect("chain: leg_left", "chain: leg_lift", "there is no chain 'leg_lift'");
  expect("cone_deg: 60", "cone_deg: 600", "180");
  expect("lower: [-350", "lower: [3500", "lower corner below the upper one");
  expect("leg_left_4_joint: 49.2", "leg_left_4_joint: -49.2", "within the joint's limits");
  expect("radius_mm: 135", "radius_mm: -1", "from 0.1");
}

TEST_F(DesignProgram, RefusesASearchsEndWhereNothingIsSearchedFor) {
  const auto refused = [&](const std::string& options, const std::string& part) {
    const ProgramResult result = RunProgram("design " + Talos() + " --chains head_trunk -o " +
                                            File("postures.yaml") + options);
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
  };
  refused(" --count 6 --plateau 0.5", "--plateau: it says where the search ends, and --count");
  refused(" --algorithm random --max-count 3", "--max-count: it is for --algorithm nocp");
}

TEST_F(DesignProgram, NamesWhatIsWrongInAPostureFile) {
  const auto expect = [&](const std::string& text, const std::string& part) {
    const ProgramResult result =
        RunProgram("assess " + Talos() + " --postures " + scratch_.Write("bad.yaml", text));
    EXPECT_EQ(result.exit_code, 3) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
  };
  expect("chains: []", "no chains");
  expect("chains: [{name: leg_lift, postures: [{}]}]", "leg_left");
  expect("chains: [{name: leg_left, postures: [{leg_left_4_joint: -1}]}]", "limits");
  expect("chains: [{name: leg_left, postures: [{leg_left_9_joint: 0}]}]", "leg_left_9_joint");
  expect("chains: [{name: leg_left}]", "postures");
}

TEST_F(DesignProgram, DoesNotReplaceWhatItReadsNorItsOwnFiles) {
  const Project project = ReadProject(Talos());
  const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
  const Recording recording = MakeSyntheticRecording(
      model, Eigen::VectorXd::Zero(model.parameter_count()), {.postures = 12});
  const std::string table = File("recording.csv");
  WritePostureTable(table, recording, project.tree);
  const std::string before = ReadFile(table);
  const ProgramResult assessed = RunProgram("assess " + Talos() + " --recording " + table +
                                            " --chains head_trunk --json " + table);
  EXPECT_EQ(assessed.exit_code, 3) << assessed.err;
  EXPECT_NE(assessed.err.find("this is an input"), std::string::npos) << assessed.err;
  EXPECT_EQ(ReadFile(table), before);

  for (const char* name : {"postures.yaml", "postures_summary.json", "postures_curves.csv"}) {
    const ProgramResult designed =
        RunProgram("design " + Talos() + " --chains head_trunk --count 4 -o " +
                   File("postures.yaml") + " --json " + File(name));
    EXPECT_EQ(designed.exit_code, 3) << name;
    EXPECT_NE(designed.err.find(name), std::string::npos) << designed.err;
    EXPECT_FALSE(std::filesystem::exists(File("postures.yaml")));
  }
}

TEST_F(DesignProgram, SaysAtOnceWhereItCannotWrite) {
  const std::string file = scratch_.Write("file", "");
  const auto begin = std::chrono::steady_clock::now();
  const ProgramResult result = RunProgram("design " + Talos() + " -o " + file + "/postures.yaml");
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_EQ(result.out, "");
  // Designing all chains would take ten seconds and more.
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST_F(DesignProgram, AProjectWithoutDesignSaysSo) {
  const ProgramResult result =
      RunProgram("design " + SourceFile("tests/robots/arm6_project.yaml").string() + " -o " +
                 File("postures.yaml"));
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("design"), std::string::npos);
}

// A stiff arm on a bench touches a table with its own plate. There are no feet and no cameras.
TEST_F(DesignProgram, AnArmWithoutFeetIsCalibratedByTouches) {
  const std::string project = scratch_.Write(
      "bench.yaml", "robot: {urdf: " + SourceFile("tests/robots/arm6.urdf").string() +
                        "}\ncontact:\n  plates:\n    - {name: plate, link: tool, point_mm: [0, 0, "
                        "50], normal: [0, 0, "
                        "-1], table: {centre_mm: [700, 0, 500], size_mm: [500, 500]}}\n"
                        "recording: {not_recorded_mm: {finger_left_joint: 10}}\n");
  const auto run = [](const std::string& words) {
    const ProgramResult result = RunProgram(words);
    EXPECT_EQ(result.exit_code, 0) << words << "\n" << result.out << result.err;
    return result;
  };
  run("design " + project + " -o " + File("postures.yaml") + " --count 20 --seed 1");
  const ProgramResult simulated =
      run("simulate " + project + " --postures " + File("postures.yaml") + " -o " +
          File("touches") + " --seed 1");
  EXPECT_EQ(simulated.err.find("did not come to lie flush"), std::string::npos) << simulated.err;
  run("calibrate " + project + " --recording " + File("touches") + "/observations.csv -o " +
      File("out") + " --kfold 10");
  const auto json = nlohmann::json::parse(ReadFile(File("out/summary.json")));
  const double height = json["contact"]["kfold"]["height_mm"];
  EXPECT_LT(height, 1.0);
  EXPECT_GT(height, 0.0);
}

}  // namespace
}  // namespace elastocal
