// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/common_parameters.hpp"

#include <map>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

constexpr auto kEstimated = ParameterStatus::kEstimated;
constexpr auto kHeld = ParameterStatus::kHeld;

ParameterEstimate Of(const std::string& name, ParameterStatus status = kEstimated) {
  return {.name = name,
          .unit = "m",
          .external = name.starts_with("marker."),
          .status = status,
          .value = 0.0,
          .sd = 1.0};
}

CalibrationEstimate With(std::vector<ParameterEstimate> parameters) {
  CalibrationEstimate estimate;
  estimate.parameters = std::move(parameters);
  return estimate;
}

std::vector<std::string> Names(const CommonParameters& found) {
  std::vector<std::string> names;
  for (const CommonParameter& common : found.common) names.push_back(common.name);
  return names;
}

std::map<std::string, std::string> Reasons(const CommonParameters& found) {
  std::map<std::string, std::string> reasons;
  for (const NotCompared& one : found.not_compared) reasons[one.name] = one.reason;
  return reasons;
}

using Strings = std::vector<std::string>;

TEST(CommonParameters, WhatBothTellInTheOrderOfB) {
  const auto a = With({Of("marker.M.x"), Of("j.r"), Of("k.r"), Of("k.d"), Of("i.r")});
  const auto b = With({Of("k.d"), Of("j.r"), Of("marker.M.x"), Of("l.d")});
  const CommonParameters found = FindCommonParameters(a, b);
  ASSERT_EQ(Names(found), (Strings{"k.d", "j.r"}));
  EXPECT_EQ(found.common[0].joint, "k");
  EXPECT_EQ(found.common[0].in_a, 3);
  EXPECT_EQ(found.common[0].in_b, 0);
  EXPECT_EQ(Reasons(found),
            (std::map<std::string, std::string>{{"i.r", "estimated in A, absent in B"},
                                                {"k.r", "estimated in A, absent in B"},
                                                {"l.d", "absent in A, estimated in B"}}));
}

TEST(CommonParameters, WhatOneDoesNotTellIsNotCompared) {
  const auto a = With({Of("i.r", ParameterStatus::kUnsupported), Of("i.d"), Of("k.r", kHeld)});
  const auto b = With({Of("i.r"), Of("i.d"), Of("k.r", kHeld)});
  const CommonParameters found = FindCommonParameters(a, b);
  EXPECT_EQ(Names(found), Strings{"i.d"});
  EXPECT_EQ(Reasons(found).at("i.r"), "unsupported in A, estimated in B");
  EXPECT_EQ(Reasons(found).at("k.r"), "held in both");
}

TEST(OwnerName, IsTheJointTheLegOrTheSensor) {
  EXPECT_EQ(OwnerName("arm_1_joint.theta"), "arm_1_joint");
  EXPECT_EQ(OwnerName("leg_left.compliance_rx"), "leg_left");
  EXPECT_EQ(OwnerName("arm_1_joint.torque_bias"), "arm_1_joint.torque_bias");
}

}  // namespace
}  // namespace elastocal
