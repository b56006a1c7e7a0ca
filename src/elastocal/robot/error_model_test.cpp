// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/error_model.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Names = std::vector<std::string>;

Names ParameterNames(const ErrorModel& model) {
  Names names;
  for (const Parameter& parameter : model.parameters) names.push_back(parameter.name);
  return names;
}

TEST(ErrorModel, NamesParametersInOrder) {
  const ErrorModel model = MakeErrorModel(PlanarArm(), {{"A", 0, {}}, {"B", 3, {}}});
  EXPECT_EQ(ParameterNames(model),
            (Names{"waist.T0.gamma", "waist.T0.b",  "waist.T0.alpha", "waist.T0.d",
                   "waist.T0.theta", "waist.T0.r",  "shoulder.gamma", "shoulder.b",
                   "shoulder.alpha", "shoulder.d",  "shoulder.theta", "shoulder.r",
                   "elbow.beta",     "elbow.alpha", "elbow.d",        "elbow.theta",
                   "elbow.r",        "marker.A.x",  "marker.A.y",     "marker.A.z",
                   "marker.B.x",     "marker.B.y",  "marker.B.z"}));
}

TEST(ErrorModel, KindsUnitsAndOwnersFollowTheName) {
  for (const ErrorModel& model :
       {TalosLegModel(), MakeErrorModel(RailArm(), {{"M", 7, {}}, {"N", 0, {}}})}) {
    for (const Parameter& p : model.parameters) {
      const std::string last = p.name.substr(p.name.rfind('.') + 1);
      const bool length = last.size() == 1;  // b d r x y z
      EXPECT_EQ(p.unit, length ? ParameterUnit::kMetre : ParameterUnit::kRadian) << p.name;
      if (p.kind == ParameterKind::kMarker) {
        EXPECT_EQ(p.name, "marker." + model.markers.at(p.marker).name + "." + last);
        EXPECT_EQ(p.joint, -1);
      } else if (p.kind == ParameterKind::kWaistPose) {
        EXPECT_EQ(p.name, "waist.T0." + last);
        EXPECT_EQ(p.joint, -1);
        EXPECT_EQ(p.marker, -1);
      } else {
        EXPECT_EQ(p.name, model.tree.joints.at(p.joint).name + "." + KindName(p.kind));
        EXPECT_EQ(p.marker, -1);
      }
    }
  }
}

TEST(ErrorModel, OnlyJointsThatMoveAMarkerHaveParameters) {
  const int finger_2 = FindLink(RailArm(), "finger_2_link");
  const int turret = FindLink(RailArm(), "turret_link");
  EXPECT_EQ(MakeErrorModel(RailArm(), {{"T", turret, {}}}).active_joints, (std::vector<int>{0, 1}));
  EXPECT_EQ(MakeErrorModel(RailArm(), {{"F", finger_2, {}}, {"T", turret, {}}}).active_joints,
            (std::vector<int>{0, 1, 2, 3, 5}));
  EXPECT_TRUE(MakeErrorModel(RailArm(), {}).active_joints.empty());
  EXPECT_EQ(MakeErrorModel(RailArm(), {}).parameter_count(), 6);
}

TEST(ErrorModel, RefusesDuplicateNamesAndStrangeLinks) {
  EXPECT_THROW(MakeErrorModel(PlanarArm(), {{"A", 1, {}}, {"A", 3, {}}}), std::invalid_argument);
  EXPECT_THROW(MakeErrorModel(PlanarArm(), {{"A", 4, {}}}), std::invalid_argument);
  EXPECT_THROW(MakeErrorModel(PlanarArm(), {{"A", -1, {}}}), std::invalid_argument);
}

/// The planar arm as a leg with all parts elastic.
ErrorModel ElasticArm(std::vector<Marker> markers) {
  return MakeErrorModel(
      PlanarArm(), std::move(markers), {},
      {.torsion = {0, 1}, .bending = {1}, .legs = {{"leg", 3}}, .torque_bias = true});
}

TEST(ErrorModel, ElasticParametersFollowTheirJointsAndTheLegsTheJoints) {
  const ErrorModel model = ElasticArm({{"A", 0, {}}});
  Names names = ParameterNames(model);
  names.erase(names.begin(), names.begin() + 6);
  EXPECT_EQ(names, (Names{"shoulder.gamma",
                          "shoulder.b",
                          "shoulder.alpha",
                          "shoulder.d",
                          "shoulder.theta",
                          "shoulder.r",
                          "shoulder.compliance_z",
                          "elbow.beta",
                          "elbow.alpha",
                          "elbow.d",
                          "elbow.theta",
                          "elbow.r",
                          "elbow.compliance_z",
                          "elbow.compliance_x",
                          "elbow.compliance_y",
                          "leg.compliance_x",
                          "leg.compliance_y",
                          "leg.compliance_z",
                          "leg.compliance_rx",
                          "leg.compliance_ry",
                          "leg.compliance_rz",
                          "shoulder.torque_bias",
                          "elbow.torque_bias",
                          "marker.A.x",
                          "marker.A.y",
                          "marker.A.z"}));
  ASSERT_EQ(model.leg_count(), 1);
  EXPECT_EQ(model.legs[0].joints, (std::vector<int>{0, 1}));
  EXPECT_EQ(model.active_joints, (std::vector<int>{0, 1}));
}

TEST(ErrorModel, ElasticParametersKnowWhatTheyAre) {
  const ErrorModel model = ElasticArm({});
  const auto expect = [&](const char* name, ParameterKind kind, const char* unit, int joint,
                          int leg, int axis) {
    const Parameter& p = model.parameters[FindParameter(model.parameters, name)];
    EXPECT_EQ(p.kind, kind) << name;
    EXPECT_STREQ(UnitName(p.unit), unit) << name;
    EXPECT_EQ(p.joint, joint) << name;
    EXPECT_EQ(p.leg, leg) << name;
    EXPECT_EQ(p.axis, axis) << name;
  };
  expect("shoulder.compliance_z", ParameterKind::kTorsion, "rad/(N.m)", 0, -1, 2);
  expect("elbow.compliance_x", ParameterKind::kBending, "rad/(N.m)", 1, -1, 0);
  expect("elbow.compliance_y", ParameterKind::kBending, "rad/(N.m)", 1, -1, 1);
  expect("leg.compliance_y", ParameterKind::kLegForce, "m/N", -1, 0, 1);
  expect("leg.compliance_rz", ParameterKind::kLegMoment, "rad/(N.m)", -1, 0, 2);
  expect("elbow.torque_bias", ParameterKind::kTorqueBias, "N.m", 1, 0, -1);
}

TEST(ErrorModel, SlidingJointsGiveWayInMetres) {
  const ErrorModel model = MakeErrorModel(
      RailArm(), {}, {}, {.torsion = {0}, .legs = {{"leg", 2}, {"other", 3}}, .torque_bias = true});
  const auto unit = [&](const char* name) {
    return std::string(UnitName(model.parameters[FindParameter(model.parameters, name)].unit));
  };
  EXPECT_EQ(unit("rail.compliance_z"), "m/N");
  EXPECT_EQ(unit("rail.torque_bias"), "N");
  // The two legs have the same sensor.
  EXPECT_EQ(MatchParameters(model.parameters, {"rail.torque_bias"}).size(), 1u);
}

TEST(ErrorModel, RefusesImpossibleElasticity) {
  const auto make = [](const Elasticity& elasticity) {
    return MakeErrorModel(RailArm(), {}, {}, elasticity);
  };
  EXPECT_THROW(make({.torsion = {7}}), std::invalid_argument);
  EXPECT_THROW(make({.bending = {-1}}), std::invalid_argument);
  EXPECT_THROW(make({.bending = {0}}), std::invalid_argument);  // this joint slides
  EXPECT_THROW(make({.legs = {{"a", 3}, {"a", 4}}}), std::invalid_argument);
  EXPECT_THROW(make({.legs = {{"a", 0}}}), std::invalid_argument);
  EXPECT_THROW(make({.legs = {{"a", 99}}}), std::invalid_argument);
}

TEST(SelectMarkers, KeepsElasticityAndLegs) {
  const ErrorModel model = ElasticArm({{"A", 0, {}}, {"B", 3, {}}});
  EXPECT_EQ(ParameterNames(SelectMarkers(model, {"A"})),
            ParameterNames(ElasticArm({{"A", 0, {}}})));
}

TEST(SelectMarkers, IsTheModelOfTheseMarkers) {
  ErrorModel leg = TalosLegModel();
  leg.T_ref_waist = Offset(1, 2, 3);
  const ErrorModel selected = SelectMarkers(leg, {"SHANK_2", "THIGH_1"});
  const ErrorModel expected = MakeErrorModel(
      TalosLeg(), {{"SHANK_2", 4, {0.065, -0.01, -0.22}}, {"THIGH_1", 3, {0.07, 0.04, -0.09}}});
  EXPECT_EQ(ParameterNames(selected), ParameterNames(expected));
  EXPECT_EQ(selected.active_joints, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(selected.markers[0].name, "SHANK_2");
  EXPECT_EQ(selected.markers[0].p_link_marker, expected.markers[0].p_link_marker);
  EXPECT_EQ(selected.markers[1].link, 3);
  EXPECT_TRUE(selected.T_ref_waist.isApprox(leg.T_ref_waist));
}

TEST(SelectMarkers, AnUnknownNameIsAnError) {
  ExpectInputError([] { SelectMarkers(TalosLegModel(), {"FOOT1"}); },
                   {"no marker 'FOOT1'", "mean 'FOOT_1'?"});
}

TEST(SelectMarkers, RefusesOneMarkerTwice) {
  EXPECT_THROW(SelectMarkers(TalosLegModel(), {"FOOT_1", "FOOT_1"}), std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
