// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/parameters.hpp"

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

const std::vector<Parameter>& LegParameters() {
  static const std::vector<Parameter> parameters = TalosLegModel().parameters;
  return parameters;
}

std::vector<std::string> Matched(const std::vector<std::string>& patterns) {
  std::vector<std::string> names;
  for (int i : MatchParameters(LegParameters(), patterns)) {
    names.push_back(LegParameters()[i].name);
  }
  return names;
}

using Names = std::vector<std::string>;

TEST(Parameters, NamesOfKinds) {
  EXPECT_STREQ(KindName(ParameterKind::kTheta), "theta");
  EXPECT_STREQ(KindName(ParameterKind::kGamma), "gamma");
  EXPECT_STREQ(KindName(ParameterKind::kMarker), "marker");
  EXPECT_STREQ(KindName(ParameterKind::kTorsion), "torsion");
  EXPECT_STREQ(KindName(ParameterKind::kTorqueBias), "torque_bias");
  for (int i = 0; i < kParameterKindCount; ++i) {
    const auto kind = static_cast<ParameterKind>(i);
    EXPECT_EQ(IsExternal(kind),
              kind == ParameterKind::kWaistPose || kind == ParameterKind::kMarker);
  }
}

TEST(Parameters, CompliancesBiasesAndCorrectionsAreElastic) {
  std::string compliances, elastic;
  for (int i = 0; i < kParameterKindCount; ++i) {
    const auto kind = static_cast<ParameterKind>(i);
    if (IsCompliance(kind)) compliances += std::string(KindName(kind)) + " ";
    if (IsElastic(kind)) elastic += std::string(KindName(kind)) + " ";
    EXPECT_FALSE(IsElastic(kind) && (IsAngle(kind) || IsExternal(kind))) << KindName(kind);
  }
  EXPECT_EQ(compliances, "torsion bending base_force base_moment ");
  EXPECT_EQ(elastic, "torsion bending base_force base_moment torque_bias correction ");
}

TEST(Parameters, FindsByName) {
  const int i = FindParameter(LegParameters(), "leg_4.beta");
  EXPECT_EQ(LegParameters()[i].name, "leg_4.beta");
  ExpectInputError([] { FindParameter(LegParameters(), "leg_4.bata"); },
                   {"no parameter 'leg_4.bata'", "mean 'leg_4.beta'?"});
}

TEST(Parameters, MatchesPatterns) {
  EXPECT_EQ(Matched({"leg_2.*"}), (Names{"leg_2.alpha", "leg_2.d", "leg_2.theta", "leg_2.r"}));
  EXPECT_EQ(Matched({"*.beta"}), (Names{"leg_4.beta", "leg_5.beta"}));
  EXPECT_EQ(Matched({"leg_*.b"}), Names{"leg_1.b"});
  EXPECT_EQ(Matched({"marker.*_1.z", "waist.T0.r"}),
            (Names{"waist.T0.r", "marker.THIGH_1.z", "marker.SHANK_1.z", "marker.FOOT_1.z"}));
  EXPECT_EQ(Matched({"leg_2.d", "leg_2.d", "leg_2.d*"}), Names{"leg_2.d"});
  EXPECT_EQ(Matched({"*"}).size(), LegParameters().size());
  EXPECT_EQ(Matched({"l*g*2*e*"}), Names{"leg_2.theta"});
  EXPECT_TRUE(Matched({}).empty());
}

void Check(const std::vector<std::string>& patterns) { CheckPatterns(LegParameters(), patterns); }

TEST(Parameters, APatternMayMatchNothing) {
  EXPECT_EQ(Matched({"leg_7.*", "leg_2.d"}), Names{"leg_2.d"});
}

TEST(Parameters, APatternThatMatchesNothingCanBeRefused) {
  ExpectInputError([] { Check({"leg_2.*", "leg_7.*"}); }, {"'leg_7.*' matches no parameter"});
  ExpectInputError([] { Check({"leg_2.thet"}); }, {"'leg_2.thet'", "mean 'leg_2.theta'?"});
  // A pattern must match the whole name, and case counts.
  ExpectInputError([] { Check({"leg_2"}); }, {"'leg_2'"});
  ExpectInputError([] { Check({"*.D"}); }, {"'*.D'"});
}

TEST(Parameters, ManyStarsAreNoWork) {
  ExpectInputError([] { Check({std::string(30, '*') + "#"}); }, {"matches no parameter"});
}

}  // namespace
}  // namespace elastocal
