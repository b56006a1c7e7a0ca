// SPDX-License-Identifier: Apache-2.0
#include "elastocal/identifiability/base_parameters.hpp"

#include <algorithm>
#include <iterator>
#include <map>

#include <gtest/gtest.h>

#include "elastocal/robot/kinematics.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Names = std::vector<std::string>;

Names NamesOf(const ErrorModel& model, const std::vector<int>& which) {
  Names names;
  for (int i : which) names.push_back(model.parameters[i].name);
  return names;
}

/// All parameters that the paper holds by hand.
const Names kHeldByThePaper = {"waist.T0.*", "leg_1.*", "leg_6.*"};

IdentifiabilityOptions Options(const Names& hold, double tolerance = 1e-6) {
  IdentifiabilityOptions options;
  options.hold = hold;
  options.tolerance = tolerance;
  return options;
}

TEST(BaseParameters, LegHasTheTheoreticalCount) {
  const ErrorModel leg = TalosLegModel();
  const BaseParameters base = FindBaseParameters(leg, {});
  EXPECT_EQ(base.theoretical_count, 4 * 6 + 3 * 9);
  EXPECT_EQ(base.kept.size(), 51u);
  EXPECT_EQ(base.dropped.size(), leg.parameters.size() - 51u);
  EXPECT_TRUE(base.held.empty());
  EXPECT_TRUE(LostBySpecialMarkers(leg, {}).empty());
}

TEST(BaseParameters, LegAsHeldByThePaper) {
  const ErrorModel leg = TalosLegModel();
  const BaseParameters base = FindBaseParameters(leg, Options(kHeldByThePaper));
  EXPECT_EQ(base.held.size(), 6u + 6u + 4u);
  EXPECT_EQ(base.kept.size(), 43u);
  EXPECT_EQ(base.kept.size() + base.dropped.size(), 45u);
  const BaseParameters one_beta =
      FindBaseParameters(leg, Options({"waist.T0.*", "leg_1.*", "leg_6.*", "leg_5.beta"}));
  EXPECT_EQ(one_beta.kept.size(), 42u);
  EXPECT_EQ(one_beta.kept.size() + one_beta.dropped.size(), 44u);
}

TEST(BaseParameters, TheGapIsWideSoThatTheToleranceHardlyMatters) {
  const ErrorModel leg = TalosLegModel();
  const Eigen::MatrixXd factor = NominalFactor(leg, {});
  for (const Names& hold : {Names{}, kHeldByThePaper}) {
    const BaseParameters base = FindBaseParameters(leg, factor, Options(hold));
    EXPECT_GT(base.smallest_kept, 1e-2);
    EXPECT_LT(base.largest_dropped, 1e-12);
    for (double tolerance : {1e-10, 1e-8, 1e-3}) {
      EXPECT_EQ(FindBaseParameters(leg, factor, Options(hold, tolerance)).kept, base.kept);
    }
  }
}

TEST(BaseParameters, ExternalFirstDropsWhatThePaperHolds) {
  const ErrorModel leg = TalosLegModel();
  EXPECT_EQ(NamesOf(leg, FindBaseParameters(leg, {}).dropped),
            (Names{"leg_1.gamma", "leg_1.b", "leg_1.alpha", "leg_1.d", "leg_1.theta", "leg_1.r",
                   "leg_4.r", "leg_5.r", "leg_6.theta", "leg_6.r"}));
}

TEST(BaseParameters, ExternalLastKeepsOffsetsFirst) {
  const ErrorModel leg = TalosLegModel();
  IdentifiabilityOptions options;
  options.external = ExternalPriority::kLast;
  const BaseParameters base = FindBaseParameters(leg, options);
  EXPECT_EQ(base.kept.size(), 51u);  // a different choice of the same number
  for (const char* joint : {"leg_1", "leg_2", "leg_3", "leg_4", "leg_5", "leg_6"}) {
    const int theta = FindParameter(leg.parameters, std::string(joint) + ".theta");
    EXPECT_TRUE(std::binary_search(base.kept.begin(), base.kept.end(), theta)) << joint;
  }
  for (int i : base.dropped) {
    EXPECT_NE(leg.parameters[i].kind, ParameterKind::kTheta) << leg.parameters[i].name;
  }
}

TEST(BaseParameters, PriorityAmongParametersOfTheSameEffect) {
  const ErrorModel leg = TalosLegModel();
  const std::vector<int> same =
      MatchParameters(leg.parameters, {"waist.T0.d", "leg_2.*", "marker.FOOT_1.x"});
  Eigen::MatrixXd factor = Eigen::MatrixXd::Identity(leg.parameter_count(), leg.parameter_count());
  for (int i : same) factor.col(i) = Eigen::VectorXd::Unit(leg.parameter_count(), same[0]);
  const auto kept = [&](ExternalPriority external, const Names& hold) {
    IdentifiabilityOptions options = Options(hold);
    options.external = external;
    const BaseParameters base = FindBaseParameters(leg, factor, options);
    std::vector<int> both;
    std::set_intersection(base.kept.begin(), base.kept.end(), same.begin(), same.end(),
                          std::back_inserter(both));
    return NamesOf(leg, both);
  };
  // Each parameter that is held leaves its place to the next one.
  using enum ExternalPriority;
  EXPECT_EQ(kept(kFirst, {}), Names{"waist.T0.d"});
  EXPECT_EQ(kept(kFirst, {"waist.*"}), Names{"marker.FOOT_1.x"});
  EXPECT_EQ(kept(kFirst, {"waist.*", "marker.*"}), Names{"leg_2.theta"});
  EXPECT_EQ(kept(kLast, {}), Names{"leg_2.theta"});
  EXPECT_EQ(kept(kLast, {"*.theta"}), Names{"leg_2.d"});
  EXPECT_EQ(kept(kLast, {"*.theta", "*.d"}), Names{"leg_2.r"});
  EXPECT_EQ(kept(kLast, {"*.theta", "*.d", "*.r"}), Names{"leg_2.alpha"});
  EXPECT_EQ(kept(kLast, {"leg_2.*"}), Names{"waist.T0.d"});
  EXPECT_EQ(kept(kLast, {"leg_2.*", "waist.*"}), Names{"marker.FOOT_1.x"});
}

TEST(BaseParameters, KeptDroppedAndHeldArePartsOfTheModelInOrder) {
  const ErrorModel leg = TalosLegModel();
  const BaseParameters base = FindBaseParameters(leg, Options({"leg_3.*", "*.z"}));
  std::vector<int> all;
  for (const auto* part : {&base.kept, &base.dropped, &base.held}) {
    EXPECT_TRUE(std::is_sorted(part->begin(), part->end()));
    all.insert(all.end(), part->begin(), part->end());
  }
  std::sort(all.begin(), all.end());
  for (int i = 0; i < leg.parameter_count(); ++i) EXPECT_EQ(all.at(i), i);
  EXPECT_EQ(base.held, MatchParameters(leg.parameters, {"leg_3.*", "*.z"}));
  // A pattern may name joints that this model does not have.
  EXPECT_TRUE(FindBaseParameters(leg, Options({"leg_7.*"})).held.empty());
}

TEST(BaseParameters, DroppedErrorsMoveMarkersAsTheKeptDoByTheRegrouping) {
  const ErrorModel leg = TalosLegModel();
  Random random(3);
  const double eps = 1e-5;
  for (ExternalPriority external : {ExternalPriority::kFirst, ExternalPriority::kLast}) {
    IdentifiabilityOptions options;
    options.external = external;
    const BaseParameters base = FindBaseParameters(leg, options);
    for (std::size_t j = 0; j < base.dropped.size(); ++j) {
      Eigen::VectorXd dropped = Eigen::VectorXd::Zero(leg.parameter_count());
      Eigen::VectorXd kept = dropped;
      dropped[base.dropped[j]] = eps;
      kept(base.kept) = eps * base.regrouping.col(static_cast<Eigen::Index>(j));
      for (int i = 0; i < 10; ++i) {
        const Eigen::VectorXd q = RandomPosture(leg.tree, random);
        const Eigen::Matrix3Xd difference = MarkerPositions(leg, ApplyErrors(leg, dropped), q) -
                                            MarkerPositions(leg, ApplyErrors(leg, kept), q);
        // The displacements (some 1e-4 m) are equal to first order. The rest is of the order of the
        // squared errors.
        EXPECT_LT(difference.cwiseAbs().maxCoeff(), 5.0 * (eps * eps + kept.squaredNorm()))
            << leg.parameters[base.dropped[j]].name;
      }
    }
  }
}

TEST(BaseParameters, SharesOfADroppedParameterLeaveOutRounding) {
  BaseParameters base;
  base.kept = {2, 5, 7};
  base.dropped = {1, 3};
  base.regrouping.resize(3, 2);
  base.regrouping << 1.0, -0.5, 0.0, 9e-10, 2.0, -1e-8;
  const std::vector<Share> shares = RegroupedInto(base, 1);
  ASSERT_EQ(shares.size(), 2u);
  EXPECT_EQ(shares[0].parameter, 2);
  EXPECT_EQ(shares[0].coefficient, -0.5);
  EXPECT_EQ(shares[1].parameter, 7);
  EXPECT_EQ(shares[1].coefficient, -1e-8);
}

TEST(BaseParameters, ElasticParametersAreKeptAndChangeNothing) {
  // The leg with everything elastic, and a branch that does nothing but carry a load.
  const ErrorModel rigid = TalosLegModel();
  RobotTree tree = TalosLeg();
  AddJoint(tree, "other", 0, Offset(0, -0.2, 0), {0, 1, 0});
  const ErrorModel model = MakeErrorModel(tree, rigid.markers, {},
                                          {.torsion = {0, 1, 2, 3, 4, 5, 6},
                                           .bending = {3},
                                           .legs = {{"leg", 6}, {"other", 7}},
                                           .torque_bias = true});
  IdentifiabilityOptions options;
  options.hold = {"leg.compliance_rz", "*.torque_bias", "leg_2.d"};
  const BaseParameters expected = FindBaseParameters(rigid, {.hold = {"leg_2.d"}});
  const BaseParameters base = FindBaseParameters(model, options);

  Names geometric;
  int elastic = 0;
  for (std::size_t i = 0; i < base.kept.size(); ++i) {
    const Parameter& p = model.parameters[base.kept[i]];
    if (IsElastic(p.kind)) {
      ++elastic;
      EXPECT_TRUE(base.regrouping.row(static_cast<Eigen::Index>(i)).isZero(0.0)) << p.name;
    } else {
      geometric.push_back(p.name);
    }
  }
  EXPECT_EQ(geometric, NamesOf(rigid, expected.kept));
  EXPECT_EQ(elastic, 7 + 2 + 6 + 6 - 1);
  EXPECT_EQ(base.geometric_count, static_cast<int>(geometric.size()));
  EXPECT_EQ(base.held.size(), 1u + 7u + 1u);
  EXPECT_EQ(base.theoretical_count, 51);
  // The shares must be those of the rigid model. (The rows of the regrouping follow `kept`.)
  const auto share = [](const ErrorModel& m, const BaseParameters& b, const std::string& name) {
    std::map<std::string, double> shares;
    for (std::size_t d = 0; d < b.dropped.size(); ++d) {
      if (m.parameters[b.dropped[d]].name != name) continue;
      for (const Share& s : RegroupedInto(b, static_cast<int>(d))) {
        shares[m.parameters[s.parameter].name] = s.coefficient;
      }
    }
    return shares;
  };
  for (const char* name : {"leg_5.r", "leg_1.b"}) {
    const auto a = share(model, base, name), b = share(rigid, expected, name);
    EXPECT_FALSE(b.empty()) << name;
    ASSERT_EQ(a.size(), b.size()) << name;
    for (const auto& [kept, coefficient] : b) EXPECT_NEAR(a.at(kept), coefficient, 1e-6) << kept;
  }
}

TEST(BaseParameters, AMarkerOnTheLastAxisLosesRank) {
  // Each body has one marker. The foot's marker is on the axis of the ankle roll, which does not
  // move it.
  ErrorModel leg = SelectMarkers(TalosLegModel(), {"THIGH_1", "SHANK_1", "FOOT_1"});
  const BaseParameters generic = FindBaseParameters(leg, {});
  EXPECT_EQ(generic.theoretical_count, 4 * 6 + 3 * 3);
  EXPECT_EQ(generic.kept.size(), 33u);
  leg.markers[2].p_link_marker = {0.05, 0, 0};
  const BaseParameters base = FindBaseParameters(leg, {});
  EXPECT_EQ(base.theoretical_count, 33);
  // The marker of the foot determines 3 + 2 parameters instead of 4 + 3: its place on the body
  // before, and its distance from that point across the axis.
  EXPECT_EQ(base.kept.size(), 31u);
  EXPECT_EQ(NamesOf(leg, LostBySpecialMarkers(leg, {})), (Names{"leg_6.alpha", "leg_6.d"}));
}

class BaseParametersOfRandomRobots : public testing::TestWithParam<int> {};

TEST_P(BaseParametersOfRandomRobots, HaveTheTheoreticalCount) {
  // This includes axes that nearly coincide or are nearly parallel: eq. 1 with beta, and the
  // general placement, describe every freedom of a joint.
  Random random(GetParam());
  std::vector<AxisRelation> relations = kUsualRelations;
  relations.push_back(AxisRelation::kCoaxial);
  const RobotTree tree = RandomRobot(relations, random);
  const ErrorModel model = MakeErrorModel(tree, RandomMarkers(tree, random));
  IdentifiabilityOptions options;
  options.postures = 200;
  for (ExternalPriority external : {ExternalPriority::kFirst, ExternalPriority::kLast}) {
    options.external = external;
    const BaseParameters base = FindBaseParameters(model, options);
    EXPECT_EQ(static_cast<int>(base.kept.size()), base.theoretical_count);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, BaseParametersOfRandomRobots, testing::Range(1, 101));

}  // namespace
}  // namespace elastocal
