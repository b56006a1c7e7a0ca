// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/io/posture_table.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {

class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    const BaseParameters base = FindBaseParameters(model_, arm_.identifiability);
    truth_ = DrawErrors(model_, base.kept, {{ParameterKind::kTheta, 0.01}}, 1);
    WritePostureTable(scratch_.path() / "recording.csv",
                      MakeSyntheticRecording(model_, truth_, {.postures = 30}), arm_.tree);
    project_ = SourceFile(kProject).string();
    recording_ = (scratch_.path() / "recording.csv").string();
    out_ = (scratch_.path() / "out").string();
  }

  /// Calibrates with `more` options, by default with fewer folds than usual. Folds take most of the
  /// time, and most tests are not about them.
  ProgramResult Calibrate(const std::string& project, const std::string& recording,
                          const std::string& more = kFewFolds) {
    return RunProgram("calibrate " + project + " --recording " + recording + " -o " + out_ + " " +
                      more);
  }

  /// The recording with one cell replaced, in this row (0: header) and column.
  std::string WithCell(int row, int column, const std::string& text) {
    std::ifstream stream(recording_);
    std::string line, changed;
    for (int r = 0; std::getline(stream, line); ++r) {
      if (r == row) {
        std::size_t begin = 0;
        for (int c = 0; c < column; ++c) begin = line.find(',', begin) + 1;
        line.replace(begin, line.find(',', begin) - begin, text);
      }
      changed += line + "\n";
    }
    return scratch_.Write("changed.csv", changed);
  }

  /// Expects that bad input is refused: exit code 3, all parts in the message, and no output at
  /// all.
  void ExpectRefused(const ProgramResult& result, std::initializer_list<std::string> parts) {
    EXPECT_EQ(result.exit_code, 3) << result.out << result.err;
    for (const std::string& part : parts) {
      EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
    }
    EXPECT_FALSE(std::filesystem::exists(out_));
  }

  /// Calibrates into `folder` from another recording of the arm, with one parameter changed.
  std::string CalibratedLater(const std::string& folder, const std::string& parameter,
                              double change) {
    Eigen::VectorXd later = truth_;
    later[FindParameter(model_.parameters, parameter)] += change;
    const std::string table = (scratch_.path() / (folder + ".csv")).string();
    WritePostureTable(table, MakeSyntheticRecording(model_, later, {.postures = 25, .seed = 9}),
                      arm_.tree);
    const std::string out = (scratch_.path() / folder).string();
    const ProgramResult result =
        RunProgram("calibrate " + project_ + " --recording " + table + " -o " + out + kFewFolds);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return out;
  }

  int Coordinate(const std::string& joint) const {
    return arm_.tree.joints[static_cast<std::size_t>(FindJoint(arm_.tree, joint))].coordinate;
  }

  static constexpr const char* kFewFolds = " --kfold 3";
  static constexpr const char* kProject = "tests/robots/arm6_project.yaml";
  ScratchFolder scratch_;
  const Project arm_ = ReadProject(SourceFile(kProject));
  const ErrorModel model_ = MakeErrorModel(arm_.tree, arm_.markers, arm_.placement);
  Eigen::VectorXd truth_;  ///< truth of the recording
  std::string project_, recording_, out_;
};

}  // namespace elastocal
