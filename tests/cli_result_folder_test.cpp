// SPDX-License-Identifier: Apache-2.0
// Damaged results are refused by their readers, and writers do not replace the files of others.

#include <cstdlib>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "elastocal/files/output_files.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

void ExpectBad(const ProgramResult& result, std::initializer_list<std::string> parts) {
  EXPECT_EQ(result.exit_code, 3) << result.out << result.err;
  for (const std::string& part : parts) {
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
  }
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// Without its folder, only the file itself shows the damage.
TEST_F(Program, ADamagedCalibrationIsRefusedByAllWhoReadIt) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string good = ReadFile(out_ + "/calibration.yaml");
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    std::filesystem::create_directories(scratch_.path() / "damaged");
    const std::string file = scratch_.Write("damaged/calibration.yaml", text);
    ExpectBad(RunProgram("validate " + project_ + " --recording " + recording_ + " --calibration " +
                         file),
              parts);
    ExpectBad(RunProgram("compare " + file + " " + out_), parts);
    scratch_.Write("damaged/summary.json", "{}");
    ExpectBad(RunProgram("report " + (scratch_.path() / "damaged").string()), parts);
  };
  const std::size_t last = good.rfind("\n  - {name");
  refused(good.substr(0, last + 1), {"calibration.yaml:", "parameters", "cut"});
  const std::size_t elbow = good.find("\n  - {name: elbow_joint.d,");
  std::string missing = good;
  missing.erase(elbow, good.find('\n', elbow + 1) - elbow);
  refused(missing, {"calibration.yaml:", "parameters", "cut"});
  const std::size_t first = good.find("\n  - {name", good.find("\nparameters:"));
  refused(good.substr(0, first) + "\n", {"calibration.yaml:", "no parameter"});
  refused("", {"calibration.yaml"});
  const std::string theta = "elbow_joint.theta, unit: ";
  refused(Replaced(good, theta + "rad", theta + "m"), {"calibration.yaml:", "unit", "'m'", "rad"});
  const std::size_t value = good.find("value: ", good.find(theta)) + 7;
  std::string degrees = good;
  degrees.replace(value, good.find(',', value) - value, "17.5");
  refused(degrees, {"calibration.yaml:", "value", "17.5"});
}

TEST_F(Program, ACalibrationOfUnknownJointsIsNotValidated) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string good = ReadFile(out_ + "/calibration.yaml");
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    ExpectBad(RunProgram("validate " + project_ + " --recording " + recording_ + " --calibration " +
                         scratch_.Write("changed.yaml", text)),
              parts);
  };
  refused(Replaced(good, "name: elbow_joint.d", "name: elbow_joit.d"),
          {"changed.yaml:", "elbow_joit", "did you mean 'elbow_joint'"});
  // Older files lack the count. A gap is noticed all the same.
  std::string gap = good;
  gap.erase(gap.find("parameter_count"),
            gap.find('\n', gap.find("parameter_count")) - gap.find("parameter_count") + 1);
  const std::size_t elbow = gap.find("\n  - {name: elbow_joint.d,");
  gap.erase(elbow, gap.find('\n', elbow + 1) - elbow);
  refused(gap, {"changed.yaml", "elbow_joint.d"});
}

// A joint log in the output folder may be called covariance.csv.
TEST_F(Program, FilesOfSomebodyElseAreNotReplaced) {
  std::filesystem::create_directories(out_);
  const std::string log = scratch_.Write("out/covariance.csv", "t,elbow_joint\n0,1\n");
  ExpectBad(Calibrate(project_, recording_), {"covariance.csv", "not replaced"});
  EXPECT_EQ(ReadFile(log), "t,elbow_joint\n0,1\n");
  std::filesystem::remove(log);
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string table = ReadFile(recording_);
  ExpectBad(RunProgram("inspect " + project_ + " --json " + recording_),
            {"recording.csv", "not replaced"});
  EXPECT_EQ(ReadFile(recording_), table);
  for (const char* name : {"calibration.yaml", "summary.json"}) {
    const std::string file = out_ + "/" + name, before = ReadFile(file);
    ExpectBad(RunProgram("inspect " + project_ + " --json " + file), {name, "not replaced"});
    EXPECT_EQ(ReadFile(file), before);
  }
  // The run's own files are replaced, and so is JSON that the user names.
  EXPECT_EQ(Calibrate(project_, recording_, "--kfold 3 --json " + out_ + "/mine.json").exit_code,
            0);
  EXPECT_EQ(Calibrate(project_, recording_, "--kfold 3 --json " + out_ + "/mine.json").exit_code,
            0);
}

TEST_F(Program, AFolderOfTwoRunsIsRefusedByItsReaders) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string later = CalibratedLater("later", "elbow_joint.theta", 5e-3);
  const auto mixed = [&](const char* name) {
    const std::filesystem::path folder = scratch_.path() / (std::string("mixed_") + name);
    std::filesystem::copy(out_, folder);
    std::filesystem::copy_file(later + "/" + name, folder / name,
                               std::filesystem::copy_options::overwrite_existing);
    return folder.string();
  };
  for (const char* name : {"calibration.yaml", "summary.json", "arm6_calibrated.urdf"}) {
    const std::string folder = mixed(name);
    ExpectBad(RunProgram("report " + folder), {name, "of two runs"});
    ExpectBad(RunProgram("compare " + folder + " " + out_), {name, "of two runs"});
    ExpectBad(RunProgram("validate " + project_ + " --recording " + recording_ + " --calibration " +
                         folder),
              {name, "of two runs"});
    // Running the command that writes this folder again repairs it.
    EXPECT_EQ(RunProgram("calibrate " + project_ + " --recording " + recording_ + " -o " + folder +
                         kFewFolds)
                  .exit_code,
              0);
    EXPECT_EQ(RunProgram("report " + folder).exit_code, 0);
  }
}

TEST_F(Program, AFullDiskLeavesTheEarlierResults) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string page = ReadFile(out_ + "/report.html");
  const std::string urdf = ReadFile(out_ + "/arm6_calibrated.urdf");
  const std::string err = (scratch_.path() / "err").string();
  // Files are limited to 30 blocks, which is too short for the page.
  const std::string command = "ulimit -f 30; " + ProgramFile() + " calibrate " + project_ +
                              " --recording " + recording_ + " -o " + out_ + " 2> " + err +
                              " > /dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 3);
  EXPECT_NE(ReadFile(err).find("cannot write " + out_), std::string::npos) << ReadFile(err);
  EXPECT_EQ(ReadFile(out_ + "/report.html"), page);
  EXPECT_EQ(ReadFile(out_ + "/arm6_calibrated.urdf"), urdf);
  for (const auto& entry : std::filesystem::directory_iterator(out_)) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
  const std::string full = ProgramFile() + " inspect " + project_ + " > /dev/full 2> " + err;
  EXPECT_EQ(WEXITSTATUS(std::system(full.c_str())), 3);
}

// A run that was killed before its commit leaves a folder, which the next run or reader removes.
TEST_F(Program, WhatAKilledRunLeftIsRemoved) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::filesystem::path left = std::filesystem::path(out_) / ".elastocal-abcdef";
  std::filesystem::create_directories(left);
  scratch_.Write("out/.elastocal-abcdef/summary.json", "{");
  scratch_.Write("out/.elastocal-abcdef/.owner", "");
  EXPECT_EQ(RunProgram("compare " + out_ + " " + out_).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(left));
}

// Paths are bytes. They are shown and written as UTF-8, without terminal commands.
TEST_F(Program, PathsThatAreNotUtf8AreShownAllTheSame) {
  const std::string table = scratch_.Write("caf\xe9\x1b[2J.csv", ReadFile(recording_));
  const std::string out = scratch_.path().string() + "/o\xff";
  const std::string json = (scratch_.path() / "a.json").string();
  ASSERT_EQ(RunProgram("calibrate " + project_ + " --recording '" + table + "' -o '" + out +
                       "' --json " + json)
                .exit_code,
            0);
  EXPECT_NE(nlohmann::json::parse(ReadFile(json))["recording"].get<std::string>().find("\uFFFD"),
            std::string::npos);
  const ProgramResult compared = RunProgram("compare '" + out + "' '" + out + "'");
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  EXPECT_EQ((compared.out + compared.err).find('\x1b'), std::string::npos);
  const ProgramResult none = RunProgram("compare '" + out + "/none\x1b[2J' " + json);
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_NE(none.err.find("/o\uFFFD/none?[2J"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace elastocal
