// SPDX-License-Identifier: Apache-2.0
// The command `batch` as its users run it: once, again, after an interruption, and with mpirun.

#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/report/page.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

class Batch : public ::testing::Test {
 protected:
  void SetUp() override {
    manifest_ = scratch_.Write("fleet.yaml",
                               "project: " + SourceFile("tests/robots/arm6_project.yaml").string() +
                                   R"(
studies:
  - name: arm
    robots: 4
    simulate: {arm-postures: 12, trials: calibration, repetitions: 1, move-s: 1, rest-s: 0.8}
)");
  }

  std::string Folder(const std::string& name) { return (scratch_.path() / name).string(); }
  ProgramResult Run(const std::string& folder, const std::string& more = "") {
    return RunProgram("batch " + manifest_ + " -o " + Folder(folder) + " " + more);
  }
  /// The data that a page shows.
  static nlohmann::json PageData(const std::string& page) {
    const std::string begin = R"(<script type="application/json" id="report-data">)";
    const std::size_t from = page.find(begin) + begin.size();
    return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  }
  std::string Read(const std::string& folder, const std::string& file) {
    return ReadFile(fs::path(Folder(folder)) / file);
  }

  ScratchFolder scratch_;
  std::string manifest_;
};

TEST_F(Batch, IsDoneOnceAndTheSameInWhateverOrder) {
  const ProgramResult first = Run("two", "--workers 2");
  ASSERT_EQ(first.exit_code, 0) << first.out << first.err;
  EXPECT_TRUE(first.out.starts_with("4 tasks: 4 to be deployed")) << first.out;
  EXPECT_FALSE(fs::exists(Folder("two") + "/arm_1_recording"));
  if (!PageTemplate().empty()) {
    const nlohmann::json page = PageData(Read("two", "fleet.html"));
    EXPECT_EQ(page["format"], "elastocal-fleet-1");
    EXPECT_EQ(page["fleet"], nlohmann::json::parse(Read("two", "fleet.json")));
    ASSERT_EQ(page["sessions"].size(), 4u);
    EXPECT_EQ(page["sessions"][2]["robot"], "arm_3");
    EXPECT_GT(page["sessions"][2]["uncalibrated_mm"], page["sessions"][2]["urdf_mm"]);
    EXPECT_TRUE(page["prior"]);
  }
  ASSERT_EQ(Run("one", "--workers 1").exit_code, 0);
  for (const char* file : {"prior/covariance.csv", "family.csv", "arm_3/covariance.csv"}) {
    EXPECT_EQ(Read("one", file), Read("two", file)) << file;
  }
  const auto made = fs::last_write_time(Folder("two") + "/arm_2/calibration.yaml");
  fs::remove(Folder("two") + "/arm_3.done.json");  // as if interrupted
  ASSERT_EQ(Run("two").exit_code, 0);
  EXPECT_EQ(fs::last_write_time(Folder("two") + "/arm_2/calibration.yaml"), made);
  EXPECT_TRUE(fs::exists(Folder("two") + "/arm_3.done.json"));
  EXPECT_EQ(Read("one", "prior/covariance.csv"), Read("two", "prior/covariance.csv"));
}

TEST_F(Batch, TwoInOneFolderAreRefused) {
  fs::create_directory(Folder("shared"));
  const std::string file = scratch_.Write("shared/.batch.lock", "4711\n");
  const int other = open(file.c_str(), O_RDWR);
  ASSERT_EQ(flock(other, LOCK_SH), 0);  // even a shared lock must stop a batch
  const ProgramResult second = Run("shared");
  EXPECT_EQ(second.exit_code, 3);
  EXPECT_NE(second.err.find("another batch (process 4711) is at work in this folder"),
            std::string::npos)
      << second.err;
  EXPECT_FALSE(fs::exists(Folder("shared") + "/arm_1.log"));
  close(other);
  EXPECT_EQ(Run("shared").exit_code, 0);  // the lock counts only while it is held
}

TEST_F(Batch, ThePriorOfAFleetServesTheNextRobot) {
  ASSERT_EQ(Run("fleet").exit_code, 0);
  const std::string project = SourceFile("tests/robots/arm6_project.yaml").string();
  ASSERT_EQ(RunProgram("simulate " + project + " -o " + Folder("next") +
                       " --seed 9 --arm-postures 6 --random-postures 4 --repetitions 1 -q")
                .exit_code,
            0);
  const ProgramResult result =
      RunProgram("calibrate " + project + " --recording " + Folder("next") + " --prior " +
                 Folder("fleet") + "/prior --days 0 -o " + Folder("out"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  // The prior counts: without it, the estimates are different.
  ASSERT_EQ(RunProgram("calibrate " + project + " --recording " + Folder("next") + " -o " +
                       Folder("alone"))
                .exit_code,
            0);
  EXPECT_NE(Read("out", "covariance.csv"), Read("alone", "covariance.csv"));

  // The errors of this session refer to another frame, so it does not belong to the family.
  std::string text = Read("fleet", "arm_2/calibration.yaml");
  const std::size_t at = text.find("gauge: prior");
  ASSERT_NE(at, std::string::npos);
  scratch_.Write("fleet/arm_2/calibration.yaml", text.replace(at, 12, "gauge: nominal_markers"));
  fs::remove(Folder("fleet") + "/arm_2/SHA256SUMS");
  ASSERT_EQ(Run("fleet").exit_code, 0);
  const std::string report = Read("fleet", "fleet.json");
  EXPECT_NE(report.find("arm_2: with another gauge of the root link"), std::string::npos) << report;
}

TEST_F(Batch, TheSameUnderMpirun) {
  if (std::system("mpirun --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no mpirun";
  ASSERT_EQ(Run("alone").exit_code, 0);
  const std::string command = "mpirun --allow-run-as-root --oversubscribe -n 2 " + ProgramFile() +
                              " batch " + manifest_ + " -o " + Folder("ranks") + " -q >" +
                              Folder("mpirun.log") + " 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << ReadFile(Folder("mpirun.log"));
  for (const char* file : {"prior/covariance.csv", "family.csv", "arm_4/covariance.csv"}) {
    EXPECT_EQ(Read("alone", file), Read("ranks", file)) << file;
  }
}

/// Shells make their background processes ignore Ctrl-C. SIGTERM is treated in the same way.
TEST_F(Batch, AnInterruptionSaysHowFarItCame) {
  std::string manifest = ReadFile(manifest_);
  scratch_.Write("fleet.yaml", manifest.replace(manifest.find("robots: 4"), 9, "robots: 400"));
  const std::string out = Folder("out"), log = Folder("log");
  const std::string command = ProgramFile() + " batch " + manifest_ + " -o " + out +
                              " --workers 1 2>" + log + " & process=$!; while [ ! -e " + out +
                              "/arm_1.done.json ] && kill -0 $process; do sleep 0.02; done; kill "
                              "-TERM $process; wait $process; test $? -eq 143";
  EXPECT_EQ(std::system(command.c_str()), 0);
  const std::string said = ReadFile(log);
  EXPECT_NE(said.find("interrupted: "), std::string::npos) << said;
  EXPECT_NE(said.find(" of 400 tasks are done; the same command does the rest"), std::string::npos);
  EXPECT_FALSE(fs::exists(out + "/fleet.json"));
}

TEST_F(Batch, EveryOptionIsKnownBeforeTheFirstTask) {
  const std::string good = ReadFile(manifest_);
  scratch_.Write("fleet.yaml", good + "  - {name: late, robots: 2, calibrate: {kfodl: 5}}\n");
  const ProgramResult result = Run("out");
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_NE(result.err.find("task 'late_1': calibrate: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("'--kfodl'"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(Folder("out") + "/arm_1.log"));

  scratch_.Write("fleet.yaml", good + "  - {name: late, robots: 2, simulate: {arm-postures: x}}\n");
  const ProgramResult wrong_value = Run("out");
  EXPECT_EQ(wrong_value.exit_code, 3) << wrong_value.out;
  EXPECT_NE(wrong_value.err.find("task 'late_1': simulate: --arm-postures: found 'x'"),
            std::string::npos)
      << wrong_value.err;
  EXPECT_FALSE(fs::exists(Folder("out") + "/arm_1.log"));
}

/// When mpirun receives Ctrl-C, it sends SIGTERM to its ranks. The first rank prints the message.
TEST_F(Batch, AnInterruptedRankSaysHowFarTheBatchCame) {
  if (std::system("mpirun --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no mpirun";
  std::string manifest = ReadFile(manifest_);
  scratch_.Write("fleet.yaml", manifest.replace(manifest.find("robots: 4"), 9, "robots: 400"));
  const std::string out = Folder("out"), log = Folder("log");
  const std::string command =
      "mpirun --allow-run-as-root --oversubscribe -n 2 " + ProgramFile() + " batch " + manifest_ +
      " -o " + out + " >" + log + " 2>&1 & process=$!; while [ ! -e " + out +
      "/arm_1.done.json ] && kill -0 $process; do sleep 0.02; done; kill -TERM $(ps -o pid= --ppid "
      "$process | sort -n | head -1); wait $process; test $? -ne 0";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_NE(ReadFile(log).find(" of 400 tasks are done; the same command does the rest"),
            std::string::npos)
      << ReadFile(log);
}

TEST_F(Batch, RobotsWithInstrumentsAreStudied) {
  const std::string project = scratch_.Write(
      "arm.yaml", "robot: {urdf: " + SourceFile("tests/robots/arm6.urdf").string() + R"(}
chains: [{name: arm, tip: flange}]
instruments:
  trackers: [{name: tracker}]
  positions: [{name: ball, link: flange, tracker: tracker, point_mm: [50, 30, 20]}]
)");
  manifest_ = scratch_.Write("fleet.yaml", "project: " + project + R"(
studies: [{name: arm, robots: 1, simulate: {count: 30}, calibrate: {kfold: 0}}]
)");
  const ProgramResult result = Run("out");
  ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
  const nlohmann::json fleet = nlohmann::json::parse(Read("out", "fleet.json"));
  EXPECT_GT(fleet["median_urdf_rmse_3d_mm"].get<double>(), 0.0);
  EXPECT_LT(fleet["median_urdf_rmse_3d_mm"].get<double>(), 2.0);
}

TEST_F(Batch, AFailedTaskIsNamedAndTheOthersAreDone) {
  manifest_ = scratch_.Write("fleet.yaml",
                             "project: " + SourceFile("tests/robots/arm6_project.yaml").string() +
                                 R"(
sessions: [{name: gone, recording: no_such_table.csv}]
)");
  const ProgramResult result = Run("out");
  EXPECT_EQ(result.exit_code, 4);
  const std::size_t reason = result.out.find("\n  gone: ");
  ASSERT_NE(reason, std::string::npos) << result.out;
  EXPECT_NE(result.out.find("no_such_table.csv", reason), std::string::npos) << result.out;
  EXPECT_NE(ReadFile(Folder("out") + "/gone.log").find("no_such_table.csv"), std::string::npos);
  fs::create_directory(Folder("full"));
  scratch_.Write("full/other.txt", "mine");
  const ProgramResult refused = Run("full");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("holds other things"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace elastocal
