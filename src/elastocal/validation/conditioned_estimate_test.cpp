// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/conditioned_estimate.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/statistics.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

CalibrationEstimate CalibrationWith(
    const std::vector<std::pair<std::string, ParameterStatus>>& parameters) {
  CalibrationEstimate estimate;
  estimate.source = "calibration.yaml";
  for (const auto& [name, status] : parameters) {
    estimate.parameters.push_back({.name = name,
                                   .unit = "m",
                                   .external = name.starts_with("marker."),
                                   .status = status,
                                   .value = 0.5,
                                   .sd = 1.0});
  }
  return estimate;
}

std::vector<std::string> FixedNames(const std::vector<FixedParameter>& fixed) {
  std::vector<std::string> names;
  for (const FixedParameter& one : fixed) names.push_back(one.name);
  return names;
}

using Strings = std::vector<std::string>;

TEST(FixedIn, WhatTheOtherModelKeepsAtAValue) {
  using enum ParameterStatus;
  const CalibrationEstimate a = CalibrationWith({{"j1.theta", kEstimated},
                                                 {"j1.d", kHeld},
                                                 {"j1.b", kNotInModel},
                                                 {"j2.theta", kUnsupported}});
  const CalibrationEstimate b = CalibrationWith({{"j1.theta", kEstimated},
                                                 {"j1.d", kEstimated},
                                                 {"j1.b", kEstimated},
                                                 {"j1.compliance_z", kEstimated},
                                                 {"j1.torque_bias", kEstimated},
                                                 {"j2.theta", kEstimated},
                                                 {"j2.gear", kEstimated},
                                                 {"j2.backlash", kUnsupported},
                                                 {"link.mass", kEstimated},
                                                 {"link.moment_x", kEstimated},
                                                 {"gravity.tilt_x", kEstimated},
                                                 {"leg.compliance_rx", kEstimated},
                                                 {"marker.M.x", kEstimated}});
  const std::vector<FixedParameter> fixed = FixedIn(a, b);
  EXPECT_EQ(FixedNames(fixed), (Strings{"j1.d", "j1.b", "j1.compliance_z", "j2.gear", "link.mass",
                                        "link.moment_x", "gravity.tilt_x"}));
  EXPECT_EQ(fixed[0].value, 0.5);  // the value at which it is held
  EXPECT_EQ(fixed[3].value, 0.0);
  EXPECT_TRUE(FixedIn(b, a).empty());
}

// A never carried these parts, so it tells nothing about B's findings there.
TEST(FixedIn, NotOfJointsThatTheOtherDoesNotKnow) {
  using enum ParameterStatus;
  const CalibrationEstimate a = CalibrationWith({{"j1.theta", kEstimated}});
  const CalibrationEstimate b = CalibrationWith({{"j1.theta", kEstimated},
                                                 {"j2.theta", kEstimated},
                                                 {"j2.gear", kEstimated},
                                                 {"link.mass", kEstimated}});
  EXPECT_TRUE(FixedIn(a, b).empty());
}

// Conditional mean and covariance of a normal distribution by hand, with very different units.
TEST(Conditioned, ByHand) {
  using enum ParameterStatus;
  CalibrationEstimate estimate =
      CalibrationWith({{"x", kEstimated}, {"y", kEstimated}, {"z", kEstimated}});
  estimate.covariance_names = {"z", "x", "y"};
  estimate.interval_factor = 1.9;  // the noise is known
  estimate.parameters[0].value = 1e-3;
  estimate.parameters[1].value = 2.0;
  estimate.parameters[2].value = 300.0;
  Eigen::Matrix3d sd = Eigen::Vector3d(100.0, 1e-3, 1.0).asDiagonal();
  Eigen::Matrix3d correlation;
  correlation << 1.0, 0.8, 0.5,  //
      0.8, 1.0, 0.2,             //
      0.5, 0.2, 1.0;
  estimate.covariance = sd * correlation * sd;
  const CalibrationEstimate found = Conditioned(estimate, {{"z", 200.0}});
  EXPECT_EQ(found.covariance_names, (Strings{"x", "y"}));
  EXPECT_NEAR(found.parameters[0].value, 1e-3 - 0.8 * 1e-3, 1e-15);
  EXPECT_NEAR(found.parameters[1].value, 2.0 - 0.5, 1e-12);
  EXPECT_EQ(found.parameters[2].value, 200.0);
  EXPECT_EQ(found.parameters[2].status, ParameterStatus::kHeld);
  EXPECT_NEAR(found.parameters[0].sd, 0.6e-3, 1e-15);
  EXPECT_NEAR(found.parameters[1].sd, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(found.covariance(0, 1), (0.2 - 0.8 * 0.5) * 1e-3, 1e-15);
  // Conditioning one by one is the same as conditioning at once.
  const CalibrationEstimate both = Conditioned(estimate, {{"z", 200.0}, {"y", 3.0}});
  const CalibrationEstimate after = Conditioned(found, {{"y", 3.0}});
  EXPECT_NEAR(both.parameters[0].value, after.parameters[0].value, 1e-15);
  EXPECT_NEAR(both.parameters[0].sd, after.parameters[0].sd, 1e-15);
}

// Without z, the fit counts its squares as noise.
TEST(Conditioned, TheNoiseIsLarger) {
  using enum ParameterStatus;
  CalibrationEstimate estimate = CalibrationWith({{"x", kEstimated}, {"z", kEstimated}});
  estimate.covariance_names = {"x", "z"};
  estimate.covariance = Eigen::Matrix2d::Identity();
  estimate.interval_factor = StudentQuantile(0.975, 20.0);
  EXPECT_NEAR(Conditioned(estimate, {{"z", 6.5}}).parameters[0].sd,
              std::sqrt((20.0 + 36.0) / (20.0 + 1.0)), 1e-6);
  EXPECT_EQ(Conditioned(estimate, {{"z", 0.5}}).parameters[0].sd, 1.0);  // z explained nothing
}

// Without z the spring would be negative. It therefore stays at 0, and x changes accordingly.
TEST(Conditioned, SpringsAreNotNegative) {
  using enum ParameterStatus;
  CalibrationEstimate estimate =
      CalibrationWith({{"x", kEstimated}, {"j.compliance_z", kEstimated}, {"z", kEstimated}});
  estimate.covariance_names = {"x", "j.compliance_z", "z"};
  estimate.interval_factor = 1.9;
  estimate.covariance.resize(3, 3);
  estimate.covariance << 1.0, 0.5, 0.0,  //
      0.5, 1.0, 0.8,                     //
      0.0, 0.8, 1.0;
  estimate.parameters[2].value = 2.0;  // the spring would be 0.5 - 1.6
  const CalibrationEstimate found = Conditioned(estimate, {{"z", 0.0}});
  EXPECT_EQ(found.parameters[1].value, 0.0);
  EXPECT_EQ(found.parameters[1].status, kHeld);
  // Both determine x: the weights solve [1 0.8; 0.8 1] w = [-0.5, -2].
  EXPECT_NEAR(found.parameters[0].value, 0.5 + 0.5 * (-0.5 + 1.6) / 0.36, 1e-12);
  EXPECT_EQ(found.covariance_names, Strings{"x"});
}

TEST(Conditioned, RefusesWhatTheCovarianceDoesNotHave) {
  using enum ParameterStatus;
  CalibrationEstimate estimate = CalibrationWith({{"x", kEstimated}, {"y", kEstimated}});
  estimate.covariance_names = {"x"};
  estimate.covariance = Eigen::MatrixXd::Identity(1, 1);
  ExpectInputError([&] { Conditioned(estimate, {{"y", 0.0}}); }, {"calibration.yaml", "'y'"});
}

}  // namespace
}  // namespace elastocal
