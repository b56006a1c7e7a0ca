#include "elastocal/validation/common_parameters.hpp"

#include <gtest/gtest.h>

namespace elastocal {
namespace {

constexpr auto kEstimated = ParameterStatus::kEstimated;
constexpr auto kDropped = ParameterStatus::kDropped;
constexpr auto kHeld = ParameterStatus::kHeld;

ParameterEstimate Of(const std::string& name, ParameterStatus status = kEstimated,
                     const std::map<std::string, double>& regrouped_into = {}) {
  return {.name = name,
          .unit = "m",
          .external = name.starts_with("marker."),
          .status = status,
          .value = 0.0,
          .sd = 1.0,
          .regrouped_into = regrouped_into};
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

TEST(CommonParameters, SameBaseParametersOneByOne) {
  const auto a =
      With({Of("marker.M.x"), Of("j.r"), Of("k.r", kDropped, {{"j.r", 1.0}}), Of("k.d")});
  const auto b = With({Of("k.d"), Of("j.r"), Of("k.r", kDropped, {{"j.r", 1.0 + 1e-9}})});
  const CommonParameters found = FindCommonParameters(a, b, true);
  ASSERT_EQ(Names(found), (Strings{"k.d", "j.r"}));
  EXPECT_EQ(found.common[0].joint, "k");
  EXPECT_EQ(found.common[0].weights_a, Eigen::Vector4d(0, 0, 0, 1));
  EXPECT_EQ(found.common[0].weights_b, Eigen::Vector3d(1, 0, 0));
  EXPECT_TRUE(found.common[0].stands_for.empty());
  EXPECT_NEAR(found.common[1].stands_for.at("k.r"), 1.0, 1e-6);
  EXPECT_EQ(Reasons(found), (std::map<std::string, std::string>{{"k.r", "dropped in both"}}));
}

// Of r_j + r_k one calibration keeps j's name and the other k's.
TEST(CommonParameters, OtherChoiceOfTheSameDependentParameters) {
  const auto a = With({Of("j.r"), Of("k.r", kDropped, {{"j.r", -0.5}})});
  const auto b = With({Of("j.r", kDropped, {{"k.r", -2.0}}), Of("k.r")});
  const CommonParameters found = FindCommonParameters(a, b, true);
  ASSERT_EQ(Names(found), Strings{"k.r"});
  // B estimates k - 2 j, A j - k / 2.
  EXPECT_LT((found.common[0].weights_a - Eigen::Vector2d(-2, 0)).norm(), 1e-12);
  EXPECT_EQ(found.common[0].weights_b, Eigen::Vector2d(0, 1));
  EXPECT_TRUE(found.not_compared.empty());
  const CommonParameters without = FindCommonParameters(a, b, false);
  EXPECT_TRUE(without.common.empty());
  EXPECT_EQ(Reasons(without).at("k.r"), "dropped in A, estimated in B");
}

// A sees r_i + r_k only, B both of them: the sum can be compared, its terms cannot.
TEST(CommonParameters, OnlyTheSumIsKnownToBoth) {
  const auto a = With({Of("i.r"), Of("k.r", kDropped, {{"i.r", 1.0}}), Of("l.d")});
  const auto b = With({Of("i.r"), Of("k.r"), Of("l.d")});
  const CommonParameters found = FindCommonParameters(a, b, true);
  ASSERT_EQ(Names(found), (Strings{"l.d", "k.r"}));
  EXPECT_LT((found.common[1].weights_a - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((found.common[1].weights_b - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
  EXPECT_TRUE(found.not_compared.empty());
}

// i.r contains another joint's in A, of a joint that moves no marker in B.
TEST(CommonParameters, DifferentCombinationsAreNotCompared) {
  const auto a = With({Of("i.r"), Of("k.r", kDropped, {{"i.r", 1.0}}), Of("i.d")});
  const auto b = With({Of("i.r"), Of("i.d")});
  const CommonParameters found = FindCommonParameters(a, b, true);
  EXPECT_EQ(Names(found), Strings{"i.d"});
  EXPECT_EQ(Reasons(found).at("i.r"), "stands for different combinations of parameters in A and B");
  EXPECT_EQ(Reasons(found).at("k.r"), "dropped in A, absent in B");
}

// With the printed priority joints come before markers, and contain what markers are off by.
TEST(CommonParameters, WhatContainsMarkersIsNotCompared) {
  const auto a = With({Of("i.r"), Of("i.d"), Of("marker.M.x", kDropped, {{"i.r", 1.0}})});
  const CommonParameters found = FindCommonParameters(a, a, true);
  EXPECT_EQ(Names(found), Strings{"i.d"});
  EXPECT_EQ(Reasons(found).at("i.r"), "cannot be told from where the waist and the markers are");
  // The other way round a joint parameter may well be dropped beside a marker.
  const auto b = With({Of("i.r", kDropped, {{"marker.M.x", 1.0}}), Of("i.d"), Of("marker.M.x")});
  EXPECT_EQ(Reasons(FindCommonParameters(b, b, true)).at("i.r"), "dropped in both");
}

// What one calibration takes as nominal is no part of what the other's parameters stand for.
TEST(CommonParameters, HeldParametersAreTakenAsKnown) {
  const auto a = With({Of("i.r"), Of("k.r", kDropped, {{"i.r", 1.0}}), Of("l.d")});
  const auto b = With({Of("i.r"), Of("k.r", kHeld), Of("l.d", kHeld)});
  const CommonParameters found = FindCommonParameters(a, b, true);
  EXPECT_EQ(Names(found), Strings{"i.r"});
  EXPECT_EQ(Reasons(found).at("l.d"), "estimated in A, held in B");
}

TEST(CommonParameters, UnsupportedIsNotEstimated) {
  const auto a = With({Of("i.r", ParameterStatus::kUnsupported), Of("i.d")});
  const auto b = With({Of("i.r"), Of("i.d")});
  const CommonParameters found = FindCommonParameters(a, b, true);
  EXPECT_EQ(Names(found), Strings{"i.d"});
  EXPECT_EQ(Reasons(found).at("i.r"), "unsupported in A, estimated in B");
}

TEST(OwnerName, IsTheJointTheLegOrTheSensor) {
  EXPECT_EQ(OwnerName("arm_1_joint.theta"), "arm_1_joint");
  EXPECT_EQ(OwnerName("leg_left.compliance_rx"), "leg_left");
  EXPECT_EQ(OwnerName("arm_1_joint.torque_bias"), "arm_1_joint.torque_bias");
}

}  // namespace
}  // namespace elastocal
