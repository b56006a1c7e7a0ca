// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/test_files.hpp"

namespace elastocal {

/// Tests on an invented arm with geometric errors drawn from the prior.
class InventedArm : public ::testing::Test {
 protected:
  static constexpr double kDegree = 0.017453292519943295;

  void SetUp() override {
    const Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
    model_ = MakeErrorModel(project.tree, project.markers, project.placement);
    base_ = FindBaseParameters(model_, {});
  }

  std::vector<int> All() const {
    std::vector<int> all(model_.parameters.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  /// Errors of the joints, and of markers that are glued on by hand if `marker_sd` is above 0.
  Eigen::VectorXd Truth(int robot, double marker_sd = 0.0) const {
    std::map<ParameterKind, double> sd;
    for (const auto kind : {ParameterKind::kTheta, ParameterKind::kAlpha, ParameterKind::kBeta,
                            ParameterKind::kGamma}) {
      sd[kind] = 0.5 * kDegree;
    }
    for (const auto kind : {ParameterKind::kR, ParameterKind::kD, ParameterKind::kB}) {
      sd[kind] = 1e-3;
    }
    if (marker_sd > 0.0) sd[ParameterKind::kMarker] = marker_sd;
    return DrawErrors(model_, All(), sd, 100 + static_cast<std::uint64_t>(robot));
  }

  ErrorModel model_;
  BaseParameters base_;
};

}  // namespace elastocal
