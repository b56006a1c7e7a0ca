// SPDX-License-Identifier: Apache-2.0
// A writing command that is killed at any moment leaves one run's files, all readable.
//
// Each command runs over a good folder of an earlier run and is killed after a random time. What it
// leaves must be all of the earlier run or all of the new one. ELASTOCAL_KILLS sets how many times
// (default 6), ELASTOCAL_KILLS_FROM the earliest moment as a share of the run (default 0).

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <map>
#include <regex>
#include <sstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/math/random.hpp"
#include "tests/arm_posture.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;
using Seconds = std::chrono::duration<double>;

int Kills() {
  const char* given = std::getenv("ELASTOCAL_KILLS");
  return given != nullptr ? std::atoi(given) : 6;
}

double EarliestKill() {
  const char* given = std::getenv("ELASTOCAL_KILLS_FROM");
  return given != nullptr ? std::atof(given) : 0.0;
}

pid_t Start(const std::string& arguments) {
  const pid_t child = fork();
  if (child != 0) return child;
  const int nowhere = open("/dev/null", O_RDWR);
  for (int descriptor = 0; descriptor < 3; ++descriptor) dup2(nowhere, descriptor);
  std::istringstream stream(arguments);
  std::vector<std::string> words = {ProgramFile()};
  for (std::string word; stream >> word;) words.push_back(word);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

/// The text without durations, in which alone two runs of one command differ.
std::string WithoutDurations(const std::string& text) {
  static const std::regex duration(
      R"re("(time_s|seconds|solve_seconds|planning_s)": ?[-+.e0-9]+)re");
  return std::regex_replace(text, duration, "");
}

using Files = std::map<std::string, std::string>;

/// All files of a folder by their names.
Files FilesOf(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    EXPECT_TRUE(entry.is_regular_file()) << entry.path();
    if (entry.path().filename() == "SHA256SUMS") {  // contains hashes of durations
      const std::string check =
          "cd '" + folder.string() + "' && sha256sum --check --quiet SHA256SUMS";
      EXPECT_EQ(std::system(check.c_str()), 0) << folder;
      continue;
    }
    files[entry.path().filename()] = WithoutDurations(ReadFile(entry.path()));
  }
  return files;
}

/// Names of the files that differ between two folders.
std::string DifferencesOf(const Files& a, const Files& b) {
  std::string names;
  for (const auto& [name, text] : a) {
    const auto other = b.find(name);
    if (other == b.end() || other->second != text) names += name + " ";
  }
  for (const auto& [name, text] : b) names += a.contains(name) ? "" : name + " ";
  return names;
}

class Killed : public Program {
 protected:
  std::string Copy(const std::string& file, const std::string& name) {
    fs::copy_file(file, scratch_.path() / name);
    return (scratch_.path() / name).string();
  }

  /// Tries to kill both commands. They write into FOLDER and differ in their input or seed.
  void TryKills(const std::string& first, const std::string& second) {
    const fs::path copy = scratch_.path() / "earlier", folder = scratch_.path() / "folder";
    Finish(first, folder);
    fs::copy(folder, copy);
    const Files earlier = FilesOf(folder);
    const auto begin = std::chrono::steady_clock::now();
    Finish(second, folder);
    const double duration = Seconds(std::chrono::steady_clock::now() - begin).count();
    const Files later = FilesOf(folder);
    ASSERT_NE(DifferencesOf(earlier, later), "");
    Random random(1);
    int left_earlier = 0;
    for (int i = 0; i < Kills(); ++i) {
      fs::remove_all(folder);
      fs::copy(copy, folder);
      const pid_t child = Start(With(second, folder));
      usleep(static_cast<useconds_t>(1e6 * random.Uniform(EarliestKill(), 1.1) * duration));
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
      RecoverOutputs(folder);
      const Files left = FilesOf(folder);
      const std::string new_ones = DifferencesOf(earlier, left),
                        old_ones = DifferencesOf(later, left);
      ASSERT_TRUE(new_ones.empty() || old_ones.empty())
          << "kill " << i << " left files of two runs; not of the earlier: " << new_ones
          << "; not of the later: " << old_ones;
      left_earlier += new_ones.empty() ? 1 : 0;
    }
    std::cout << left_earlier << " of " << Kills() << " kills left the earlier run's files\n";
    EXPECT_GT(left_earlier, 0) << "no kill came in time";
  }

  static std::string With(std::string command, const fs::path& folder) {
    for (std::size_t at; (at = command.find("FOLDER")) != std::string::npos;) {
      command.replace(at, 6, folder.string());
    }
    return command;
  }

  static void Finish(const std::string& command, const fs::path& folder) {
    const ProgramResult result = RunProgram(With(command, folder));
    ASSERT_EQ(result.exit_code, 0) << command << "\n" << result.err;
  }

  const std::string talos_ = SourceFile("models/talos/project.yaml").string();
};

TEST_F(Killed, Calibrate) {
  const std::string end = " -o FOLDER --kfold 3";
  const std::string first = Copy(recording_, "first_input.csv");
  const std::string second = Copy(recording_, "second_input.csv");
  TryKills("calibrate " + project_ + " --recording " + first + end,
           "calibrate " + project_ + " --recording " + second + end);
}

TEST_F(Killed, Validate) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string begin = "validate " + project_ + " --calibration " + out_ +
                            "/calibration.yaml -o FOLDER --recording ";
  TryKills(begin + Copy(recording_, "first_input.csv"),
           begin + Copy(recording_, "second_input.csv"));
}

TEST_F(Killed, Design) {
  const std::string end = " --count 4 --no-certificate -o FOLDER/postures.yaml";
  TryKills("design " + talos_ + " --chains head_trunk --seed 1" + end,
           "design " + talos_ + " --chains head_trunk --seed 2" + end);
}

TEST_F(Killed, Plan) {
  const std::string end = " -o FOLDER/motion.csv --trajectory FOLDER/trajectory.yaml";
  const std::string first = scratch_.Write("first_input.yaml", kPostureOfArm);
  const std::string second = scratch_.Write("second_input.yaml", kPostureOfArm);
  TryKills("plan " + talos_ + " --postures " + first + end,
           "plan " + talos_ + " --rest-s 1.5 --postures " + second + end);
}

TEST_F(Killed, Simulate) {
  const std::string end = " --arm-postures 2 --random-postures 1 -o FOLDER";
  TryKills("simulate " + project_ + " --seed 1" + end, "simulate " + project_ + " --seed 2" + end);
}

}  // namespace
}  // namespace elastocal
