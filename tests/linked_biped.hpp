// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/calibration/options.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {

/// Tests on an invented pair of legs. Actuators move the knees, and two cranks with rods move each
/// ankle.
class LinkedBiped : public testing::Test {
 protected:
  std::filesystem::path File(const std::string& name) const { return scratch_.path() / name; }

  /// Writes the recording as a table of the joints of `tree`, and reads it with the project.
  PostureTable ReadBack(const Recording& recording, const RobotTree& tree) const {
    WritePostureTable(File("table.csv"), recording, tree);
    return ReadPostureTable(File("table.csv"), project_);
  }

  Eigen::VectorXd Truth(std::uint64_t seed) const {
    Random random(seed);
    Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
    const Prior prior;
    for (int i = kWaistParameterCount; i < truth.size(); ++i) {
      const Parameter& parameter = model_.parameters[i];
      const double sd = IsExternal(parameter.kind) ? 2e-3 : prior.Of(model_.tree, parameter);
      truth[i] = random.Normal(sd);
    }
    return truth;
  }

  ScratchFolder scratch_;
  Project project_ = ReadProject(SourceFile("tests/robots/linked_biped_project.yaml"));
  ErrorModel model_ = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  RobotTree unlinked_ = [this] {
    RobotTree tree = project_.tree;
    tree.linkages.clear();
    return tree;
  }();
};

}  // namespace elastocal
