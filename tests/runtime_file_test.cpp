// SPDX-License-Identifier: Apache-2.0
// The file that brings the robot at run time to a controller.
#include <sstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

RuntimeModel TalosModel() {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  return MakeRuntimeModel(project, RandomCalibration(project, 1));
}

TEST(RuntimeFile, GivesTheSameBits) {
  const RuntimeModel model = TalosModel();
  std::stringstream file;
  WriteRuntimeModel(model, file);
  Compensator first(model), second(ReadRuntimeModel(file, "model"));
  const Eigen::VectorXd q = 0.1 * Eigen::VectorXd::LinSpaced(model.coordinate_count(), -1.0, 1.0);
  first.Command(q, Eigen::VectorXd(), 1);
  second.Command(q, Eigen::VectorXd(), 1);
  EXPECT_EQ(first.command(), second.command());
}

TEST(RuntimeFile, NamesMayHaveBlanks) {
  RuntimeModel model = TalosModel();
  model.joint_names[1] = model.coordinate_names[1] = "lift  column 2";
  model.link_names[0] = "# base link";
  std::stringstream file;
  WriteRuntimeModel(model, file);
  const RuntimeModel read = ReadRuntimeModel(file, "model");
  EXPECT_EQ(read.joint_names, model.joint_names);
  EXPECT_EQ(read.coordinate_names, model.coordinate_names);
  EXPECT_EQ(read.link_names, model.link_names);
}

TEST(RuntimeFile, OneOfAnotherVersionSaysWhatToDo) {
  std::istringstream in("elastocal-runtime-model 99\nrobot talos\n");
  try {
    ReadRuntimeModel(in, "model.txt");
    FAIL() << "it was read";
  } catch (const std::runtime_error& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("model.txt: line 1: "), std::string::npos) << said;
    EXPECT_NE(said.find("found 'elastocal-runtime-model 99'"), std::string::npos) << said;
    EXPECT_NE(said.find("same version as this library"), std::string::npos) << said;
  }
}

TEST(RuntimeFile, ADamagedOneIsRefused) {
  std::ostringstream out;
  WriteRuntimeModel(TalosModel(), out);
  const std::string good = out.str();
  const auto refused = [](const std::string& text) {
    std::istringstream in(text);
    try {
      ReadRuntimeModel(in, "model.txt");
    } catch (const std::runtime_error& error) {
      return std::string(error.what()).starts_with("model.txt: ");
    }
    return false;
  };
  EXPECT_TRUE(refused(""));
  for (std::size_t part = 1; part < 40; ++part) {
    EXPECT_TRUE(refused(good.substr(0, part * good.size() / 40))) << part;
  }
  std::string wrong = good;
  wrong.replace(wrong.find("\ncalibrated 30\n") + 1, 13, "calibrated -1");
  EXPECT_TRUE(refused(wrong));
  wrong = good;
  wrong.replace(wrong.find("gravity 3"), 9, "gravity x");
  EXPECT_TRUE(refused(wrong));
  RuntimeModel flat = TalosModel();
  flat.gravity.pop_back();
  std::ostringstream two;
  WriteRuntimeModel(flat, two);
  EXPECT_TRUE(refused(two.str()));
}

}  // namespace
}  // namespace elastocal
